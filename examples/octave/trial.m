% SPDX-License-Identifier: MIT
% Trials in Octave or MATLAB: when the stroke was at the DAC, and how long the answer took. Prints a line a trial, tab-separated.
%   tactor serve --tcp 4001 -D hw:CARD=Tactor
%   octave trial.m [PORT]         with Psychtoolbox, times are those of GetSecs
% The answer is a line that is typed here. With a window of Psychtoolbox take KbCheck in its place: its time is GetSecs', too.
port = 4001;
arguments = {};
if exist('OCTAVE_VERSION', 'builtin'), arguments = argv(); end
if ~isempty(arguments), port = str2double(arguments{1}); end
get_time = [];
if exist('GetSecs', 'file') == 3, get_time = @GetSecs; end
tactor = Tactor('127.0.0.1', port, get_time);
leave = onCleanup(@() tactor.close());    % at Ctrl-C and errors, too

paths = struct('left', 'M 35 20 L 5 20', 'right', 'M 5 20 L 35 20');
% Weak, for the first time on a card: then come up in steps of 6 dB.
options = struct('duration', 0.3, 'level_dbfs', -40);
fprintf('stroke\tstate\tonset_s\twithin_s\tresponse\tresponse_time_s\n');
for name = {'left', 'right', 'right', 'left'}
    stroke = tactor.play(struct('path', paths.(name{1}), 'options', options, 'start', struct('delay_s', 0.1)));
    response = input('Left (f) or right (j)? ', 's');
    answered_s = tactor.clock();
    report = tactor.wait(stroke);
    if ~strcmp(report.state, 'finished')    % this trial does not count
        fprintf('%s\t%s\t%s\n', name{1}, report.state, report.reason);
        continue
    end
    fprintf('%s\t%s\t%.6f\t%.6f\t%s\t%.4f\n', name{1}, report.state, report.onset_s, report.within_s, response, ...
            answered_s - report.onset_s);
end
clear leave
