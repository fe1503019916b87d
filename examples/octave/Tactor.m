% SPDX-License-Identifier: MIT
% Plays strokes through `tactor serve --tcp 4001`, and says when each was at the DAC. Runs in Octave 7 or later with its package
% instrument-control; written for MATLAB R2021a or later too, which was not tried.
%
%   tactor = Tactor('127.0.0.1', 4001);
%   stroke = tactor.play(struct('stroke', 'park2016-1'));      % parameters of `play`, as in tactor-protocol(7)
%   report = tactor.wait(stroke);                              % report.state, report.onset_s, report.within_s
%   tactor.close();
%
% Times are those of tactor.clock(): seconds since the connection, or by another clock that is handed over:
%
%   tactor = Tactor('127.0.0.1', 4001, @GetSecs);              % Psychtoolbox's
%   tactor = Tactor('192.168.1.5', 4001, @GetSecs, token);     % a service on another computer
classdef Tactor < handle
    properties (SetAccess = private)
        clock       % function that returns the time, s
    end
    properties (Access = private)
        socket
        token = ''
        received = ''
        reports = {}    % of strokes that have ended, by their number
        calls = 0
    end
    properties (Constant, Access = private)
        READINGS = 10    % of the service's clock, of which the quickest counts
        SILENCE_S = 5    % after which the service counts as away
    end

    methods
        function self = Tactor(host, port, clock, token)
            begun = tic;
            self.clock = @() toc(begun);
            if nargin >= 3 && ~isempty(clock), self.clock = clock; end
            if nargin >= 4, self.token = token; end
            if exist('OCTAVE_VERSION', 'builtin'), pkg('load', 'instrument-control'); end
            try
                self.socket = tcpclient(host, port);
            catch
                error('tactor:away', 'tactor: %s:%d cannot be reached (start tactor serve --tcp %d)', host, port, port);
            end
            self.hello();
        end

        function result = hello(self)
            params = struct('name', 'Octave or MATLAB');
            if ~isempty(self.token), params.token = self.token; end
            result = self.call('hello', params);
        end

        function result = call(self, method, params)
            % Returns the result of a method of tactor-protocol(7); an error has the service's text.
            if nargin < 3, params = struct(); end
            id = self.send(method, params);
            while true
                message = self.receive();
                if ~isfield(message, 'id') || ~isequal(message.id, id), continue; end
                if isfield(message, 'error'), error('tactor:refused', 'tactor: %s', message.error.message); end
                result = message.result;
                return
            end
        end

        function stroke = play(self, params)
            % Returns the number of the stroke.
            result = self.call('play', params);
            stroke = result.stroke;
        end

        function report = wait(self, stroke)
            % Returns how a stroke ended, once it has, with its onset at the DAC by this clock and the greatest error of that, s.
            while numel(self.reports) < stroke || isempty(self.reports{stroke}), self.receive(); end
            report = self.reports{stroke};
            report.onset_s = [];
            [ahead, report.within_s] = self.ahead_of();
            if ~isempty(report.started_s), report.onset_s = report.started_s - ahead; end
        end

        function stop(self)
            % Fades everybody's strokes.
            self.call('stop');
        end

        function close(self)
            % Fades this client's strokes, which would play on, and ends the connection.
            if isempty(self.socket), return; end
            try
                self.call('cancel', struct('all', true));
            catch
                % The service has gone, and the strokes with it.
            end
            self.socket = [];
        end

        function delete(self)
            self.close();
        end
    end

    methods (Access = private)
        function [ahead, within] = ahead_of(self)
            % Returns how far the service's clock is ahead of this one, and the greatest error, s.
            within = Inf;
            for reading = 1:self.READINGS
                before = self.clock();
                theirs = self.hello();
                after = self.clock();
                if (after - before) / 2 < within
                    within = (after - before) / 2;
                    ahead = theirs.clock.monotonic_s - (before + after) / 2;
                end
            end
        end

        function id = send(self, method, params)
            self.calls = self.calls + 1;
            id = self.calls;
            line = jsonencode(struct('jsonrpc', '2.0', 'id', id, 'method', method, 'params', params));
            write(self.socket, uint8([unicode2native(line, 'UTF-8') 10]));
        end

        function message = receive(self)
            % Returns the next message; keeps the reports of own strokes.
            silence = tic;
            asked_s = 0;
            while ~any(self.received == 10)
                if self.socket.NumBytesAvailable > 0
                    self.received = [self.received char(read(self.socket, self.socket.NumBytesAvailable))];
                    silence = tic;
                    asked_s = 0;
                elseif toc(silence) > self.SILENCE_S
                    self.socket = [];    % nothing is left to close
                    error('tactor:away', 'tactor: the service has not answered for %d s', self.SILENCE_S);
                else
                    if toc(silence) > asked_s + 1    % a stroke may last long: ask whether the service is there
                        asked_s = asked_s + 1;
                        self.send('status', struct());
                    end
                    % A pause takes a millisecond or more, and answers to `hello`, by which clocks are read, come sooner.
                    if toc(silence) > 0.01, pause(0.001); end
                end
            end
            last = find(self.received == 10, 1);
            message = jsondecode(native2unicode(uint8(self.received(1:last - 1)), 'UTF-8'));
            self.received(1:last) = [];
            if isfield(message, 'method') && strcmp(message.method, 'stroke') && ~strcmp(message.params.state, 'started')
                self.reports{message.params.stroke} = message.params;
            end
        end
    end
end
