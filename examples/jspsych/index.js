// SPDX-License-Identifier: MIT
// jsPsych plug-in: a trial plays a stroke through `tactor serve --http`, waits for its report and, if asked to, for a key.
//   <script src="jspsych-plugin-tactor/index.js"></script>        after that of jspsych; or
//   import jsPsychTactorStroke from 'jspsych-plugin-tactor';      with a bundler
//   { type: jsPsychTactorStroke, play: { stroke: 'park2016-1', options: { duration: 0.5 } }, choices: ['f', 'j'] }
// example.html has timeline variables.
// The service lists the page's host and port in allow_hosts: man/guide/runners.md.
const jsPsychTactorStroke = (({ ParameterType }) => {
  const info = {
    name: 'tactor-stroke',
    version: '0.1.0',
    parameters: {
      /** Parameters of `play`, as in tactor-protocol(7). Timeline variables and functions may stand at any depth. */
      play: { type: ParameterType.OBJECT, default: undefined },
      url: { type: ParameterType.STRING, default: 'ws://127.0.0.1:4003/rpc' },
      /** Token of the service, if it has one. */
      token: { type: ParameterType.STRING, default: null },
      prompt: { type: ParameterType.HTML_STRING, default: '' },
      /** Keys that answer; the trial then ends when the stroke has ended and a key was pressed. */
      choices: { type: ParameterType.KEYS, default: 'NO_KEYS' },
      /** Time after which the trial ends without an answer, and the stroke fades, ms; null: none. */
      trial_duration: { type: ParameterType.INT, default: null },
    },
    data: {
      /** finished, cancelled or interrupted, as the service reports; refused by the service; lost: the service is away. */
      state: { type: ParameterType.STRING },
      /** Why the state is not finished; else empty. */
      message: { type: ParameterType.STRING },
      /** Whether the stroke was not felt in full, so that the trial does not count. */
      void: { type: ParameterType.BOOL },
      /** First sample at the DAC by performance.now(), ms, and the greatest error of that; null if there was none. */
      onset: { type: ParameterType.FLOAT },
      onset_within: { type: ParameterType.FLOAT },
      /** The same by the service's CLOCK_MONOTONIC and by the time of day, s. */
      onset_s: { type: ParameterType.FLOAT },
      onset_unix_s: { type: ParameterType.FLOAT },
      /** Frames that were played. */
      frames: { type: ParameterType.INT },
      response: { type: ParameterType.STRING },
      /** From the onset to the key, ms; negative if the key came first. */
      rt: { type: ParameterType.FLOAT },
    },
  };
  const READINGS = 5; // of the service's clock, of which the quickest counts
  const SILENCE_S = 5; // after which the service counts as away

  class TactorStrokePlugin {
    static info = info;

    constructor(jsPsych) {
      this.jsPsych = jsPsych;
    }

    trial(display_element, trial) {
      const api = this.jsPsych.pluginAPI;
      const data = { state: 'lost', message: '', void: true, onset: null, onset_within: Infinity, onset_s: null, onset_unix_s: null,
        frames: 0, response: null, rt: null };
      const answers = new Map(); // handlers by the id of the call
      const sounding = new Set(); // numbers of the strokes that have not ended
      let socket, keyboard, calls = 0, silence_s = 0, ahead = 0, pressed = null;
      let was_open = false, is_planned = false, waits = trial.choices !== 'NO_KEYS', has_ended = false;

      // jsPsych evaluates what stands directly in `play`. Deeper it leaves a timeline variable as a copy, {name: ...}.
      const evaluate = (value) => {
        if (typeof value === 'function') return evaluate(value());
        if (Array.isArray(value)) return value.map(evaluate);
        if (typeof value !== 'object' || value === null) return value;
        const entries = Object.entries(value);
        if (entries.length === 1 && entries[0][0] === 'name') return evaluate(this.jsPsych.evaluateTimelineVariable(value.name));
        return Object.fromEntries(entries.map(([key, v]) => [key, evaluate(v)]));
      };
      const call = (method, params, handle) => {
        answers.set(++calls, handle);
        socket.send(JSON.stringify({ jsonrpc: '2.0', id: calls, method, params }));
      };
      // Strokes outlast their client, so a page that goes away cancels its own. Those of other clients play on.
      const leave = () => {
        if (socket?.readyState === WebSocket.OPEN) call('cancel', { all: true });
        socket?.close();
        has_ended = true;
        clearInterval(heartbeat);
        observer.disconnect();
        window.removeEventListener('pagehide', leave);
      };
      const finish = () => {
        if (has_ended) return;
        leave();
        if (keyboard) api.cancelKeyboardResponse(keyboard);
        data.void = data.state !== 'finished';
        if (data.onset === null) data.onset_within = null;
        else if (pressed !== null) data.rt = pressed - data.onset;
        this.jsPsych.finishTrial(data);
      };
      const fail = (state, message) => {
        if (has_ended) return;
        console.warn(`tactor-stroke: ${message}`);
        Object.assign(data, { state, message });
        finish();
      };
      const finish_if_done = () => {
        if (is_planned && !sounding.size && (!waits || data.state !== 'finished')) finish();
      };

      const take_report = ({ stroke, state, reason, frames, started_s, started_unix_s }) => {
        if (!sounding.has(stroke)) return;
        if (started_s !== null && (data.onset_s === null || started_s <= data.onset_s)) {
          Object.assign(data, { onset_s: started_s, onset_unix_s: started_unix_s, onset: 1000 * started_s - ahead });
        }
        if (state === 'started') return;
        sounding.delete(stroke);
        data.frames += frames;
        // A file may have several strokes; the trial is void if one of them was not felt in full.
        if (data.state === 'lost' || data.state === 'finished') Object.assign(data, { state, message: reason });
        finish_if_done();
      };
      const play = () => call('play', evaluate(trial.play), ({ strokes }) => {
        strokes.forEach((number) => sounding.add(number));
        is_planned = true;
      });
      const read_clock = (left) => {
        const before = performance.now();
        call('hello', { name: 'jsPsych', ...(trial.token === null ? {} : { token: trial.token }) }, ({ clock }) => {
          const after = performance.now();
          if ((after - before) / 2 < data.onset_within) {
            data.onset_within = (after - before) / 2;
            ahead = 1000 * clock.monotonic_s - (before + after) / 2;
          }
          if (left > 1) read_clock(left - 1);
          else play();
        });
      };
      const beat = () => {
        if (++silence_s > SILENCE_S) fail('lost', `${trial.url} has not answered for ${SILENCE_S} s`);
        else if (socket.readyState === WebSocket.OPEN) call('status', {});
      };

      const shown = document.createElement('div');
      shown.innerHTML = trial.prompt;
      display_element.replaceChildren(shown);
      const heartbeat = setInterval(beat, 1000);
      // jsPsych empties the display when the experiment is aborted, and does not tell the plug-in.
      const observer = new MutationObserver(() => { if (!shown.isConnected) leave(); });
      observer.observe(display_element, { childList: true });
      window.addEventListener('pagehide', leave);
      if (waits) {
        keyboard = api.getKeyboardResponse({ valid_responses: trial.choices, callback_function: ({ key }) => {
          pressed = performance.now();
          data.response = key;
          waits = false;
          finish_if_done();
        } });
      }
      if (trial.trial_duration !== null) {
        api.setTimeout(() => {
          waits = false;
          if (sounding.size) call('cancel', { all: true });
          else if (is_planned) finish();
          else fail('lost', `no stroke within ${trial.trial_duration} ms`);
        }, trial.trial_duration);
      }
      try {
        socket = new WebSocket(trial.url);
      } catch (e) {
        fail('lost', `url: ${e.message}`);
        return;
      }
      socket.onopen = () => { was_open = true; read_clock(READINGS); };
      socket.onclose = ({ reason }) => fail('lost', was_open ? `${trial.url} closed the connection${reason && `: ${reason}`}`
        : `${trial.url} cannot be reached (start tactor serve --http; list ${location.host} in allow_hosts)`);
      socket.onmessage = (event) => {
        silence_s = 0;
        const { id, result, error, method, params } = JSON.parse(event.data);
        if (method === 'stroke') take_report(params);
        if (error) fail('refused', error.message);
        else if (result) answers.get(id)?.(result);
        answers.delete(id);
      };
    }
  }
  return TactorStrokePlugin;
})(typeof module === 'object' ? require('jspsych') : jsPsychModule);
if (typeof module === 'object') module.exports = jsPsychTactorStroke;
