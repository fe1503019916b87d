# SPDX-License-Identifier: MIT
"""tactor serve for other programs: its sockets, their permissions, and its end."""
import json
import os
import pathlib
import resource
import signal
import socket
import stat
import subprocess

from harness import PATIENCE_S, TOOL, main
from serving import Client, ServeTest, Server


class Serve(ServeTest):
    # Sockets.

    def test_the_first_line_and_the_end(self):
        s = self.serve("--tcp", "0")
        self.assertEqual(set(s.where), {"event", "socket", "tcp", "osc", "http"})
        self.assertEqual(s.where["event"], "listening")
        self.assertRegex(s.where["tcp"], r"^127\.0\.0\.1:[1-9]\d*$")
        self.assertIsNone(s.where["osc"])
        self.assertIsNone(s.where["http"])
        status, out, err = s.terminate()
        self.assertEqual((status, out), (0, ""), err)
        self.assertIn("every user of this machine", err)
        self.assertFalse(os.path.exists(s.where["socket"]))

    def test_a_page_alone_needs_no_folder_for_a_socket(self):
        s = self.serve("--http", "0", env={"XDG_RUNTIME_DIR": "", "RUNTIME_DIRECTORY": ""})
        self.assertIsNone(s.where["socket"])
        self.assertRegex(s.where["http"], "^http://127")
        self.assertEqual(s.terminate()[0], 0)
        self.refused(2, "serve", "--socket", "", "--http", "0", "-D", "null")

    def test_a_program_that_it_starts_inherits_no_descriptor(self):
        s = self.serve("--tcp", "0", "--http", "0", "--osc", "0")
        s.client().ok("hello")
        process = pathlib.Path(f"/proc/{s.process.pid}")
        inherited = [os.readlink(process / "fd" / f.name) for f in (process / "fdinfo").iterdir()
                     if int(f.name) > 2 and not int(f.read_text(encoding="ascii").split()[3], 8) & os.O_CLOEXEC]
        self.assertLessEqual(set(inherited), {"/dev/null"})  # ALSA's own, of the device "null"

    def test_sigint_ends_it_too(self):
        self.assertEqual(self.serve().terminate(signal.SIGINT)[0], 0)

    def test_it_ends_well_with_any_signals(self):
        for other in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM):
            s = self.serve()
            s.process.send_signal(signal.SIGTERM)
            try:
                s.process.send_signal(other)
            finally:
                self.assertEqual(s.process.wait(PATIENCE_S), 0)
            self.assertFalse(os.path.exists(s.where["socket"]))

    def test_the_socket_of_another_server_stays(self):
        path = self.dir / "s"
        first = self.serve("--socket", path)
        path.unlink()
        second = self.serve("--socket", path)
        first.process.send_signal(signal.SIGTERM)
        self.assertEqual(first.process.wait(PATIENCE_S), 0)
        self.assertEqual(second.client().ok("hello")["protocol"], "tactor/1")

    def test_the_socket_has_its_mode_under_any_umask(self):
        before = os.umask(0)
        self.addCleanup(os.umask, before)
        for mask in (0, 0o777, 0o22):
            os.umask(mask)
            try:
                file = self.dir / f"mask{mask}"
                env = {"XDG_RUNTIME_DIR": str(self.dir)}
                os.umask(0o22)
                self.write("serve.toml", "")
                os.umask(mask)
                s = Server(self, "--socket", file, env=env)
            finally:
                os.umask(0o22)
            self.assertIsNotNone(s.where, getattr(s, "errors", ""))
            self.assertEqual(stat.S_IMODE(file.stat().st_mode), 0o600)
            self.assertEqual(s.terminate()[0], 0)

    def test_the_system_s_socket_belongs_to_the_group(self):
        (self.dir / "run").mkdir()
        s = self.serve(env={"RUNTIME_DIRECTORY": str(self.dir / "run"), "XDG_RUNTIME_DIR": str(self.dir / "user")})
        self.assertEqual(s.where["socket"], str(self.dir / "run/tactor.sock"))
        self.assertEqual(stat.S_IMODE(os.stat(s.where["socket"]).st_mode), 0o660)

    def test_a_user_s_default_socket(self):
        s = self.serve(env={"XDG_RUNTIME_DIR": str(self.dir)})
        self.assertEqual(s.where["socket"], str(self.dir / "tactor.sock"))
        self.assertEqual(stat.S_IMODE(os.stat(s.where["socket"]).st_mode), 0o600)

    def test_a_second_server_names_the_holder_of_the_socket(self):
        first = self.serve()
        self.refuses_to_start(3, says=f"process {first.process.pid}")
        self.assertEqual(first.client().ok("status")["amplifier"], "none")

    def test_a_killed_server_s_socket_is_replaced_and_nothing_else(self):
        first = self.serve()
        first.kill()
        self.assertTrue(os.path.exists(first.where["socket"]))
        self.assertEqual(self.serve().terminate()[0], 0)
        self.write("s.sock", "mine")
        self.refuses_to_start(2, says="no socket")
        self.assertEqual((self.dir / "s.sock").read_text(), "mine")

    def test_inherited_sockets_win_and_stay(self):
        path = str(self.dir / "given.sock")
        with socket.socket(socket.AF_UNIX) as given:
            given.bind(path)
            given.listen()
            os.set_inheritable(given.fileno(), True)
            command = f'exec 3<&{given.fileno()}; export LISTEN_PID=$$; exec "$@"'
            p = subprocess.Popen(["sh", "-c", command, "sh", TOOL, "serve", "-D", "null", "--format", "json"],
                                 stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=self.dir,
                                 pass_fds=[given.fileno()],
                                 env=self.env | {"LISTEN_FDS": "1", "LISTEN_FDNAMES": "socket"})
            self.addCleanup(p.stdout.close)
            self.assertEqual(json.loads(p.stdout.readline())["socket"], path)
            self.assertEqual(Client(path).ok("hello")["protocol"], "tactor/1")
            p.terminate()
            self.assertEqual(p.wait(PATIENCE_S), 0)
            self.assertTrue(os.path.exists(path))

    def test_inherited_sockets_are_checked_like_bound_ones(self):
        open_to_all = str(self.dir / "open.sock")
        with socket.socket(socket.AF_UNIX) as given, socket.socket(socket.AF_UNIX) as nameless:
            given.bind(open_to_all)
            nameless.bind("\0" + open_to_all)
            for s in (given, nameless):
                s.listen()
            for mode, sockets, why in ((0o666, [given], "every user of this machine may write to it"),
                                       (0o660, [given, given], "there are two of that name"),
                                       (0o660, [nameless], "it is no file")):
                os.chmod(open_to_all, mode)
                passed = "".join(f"exec {3 + i}<&{s.fileno()}; " for i, s in enumerate(sockets))
                r = subprocess.run(["sh", "-c", f'{passed}export LISTEN_PID=$$; exec "$@"', "sh", TOOL, "serve", "-D", "null"],
                                   capture_output=True, text=True, cwd=self.dir, pass_fds=[s.fileno() for s in set(sockets)],
                                   env=self.env | {"LISTEN_FDS": str(len(sockets)),
                                                   "LISTEN_FDNAMES": ":".join(["socket"] * len(sockets))},
                                   timeout=PATIENCE_S, check=False)
                self.assertEqual((r.returncode, r.stdout), (2, ""), r.stderr)
                self.assertIn('inherited socket "socket"', r.stderr)
                self.assertIn(why, r.stderr)

    def test_it_notifies_its_manager(self):
        path = str(self.dir / "notify")
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
            manager.bind(path)
            manager.settimeout(PATIENCE_S)
            s = self.serve("--socket", self.dir / "n.sock", env={"NOTIFY_SOCKET": path, "WATCHDOG_USEC": "200000"})
            said = set()
            while len(said) < 3:  # on a slow machine the watchdog is fed more than once before the rest comes
                said.add(manager.recv(1000))
            self.assertEqual(said, {b"READY=1", b"WATCHDOG=1", b"STATUS=stream: running"})
            for _ in range(2):  # repeatedly
                while manager.recv(1000) != b"WATCHDOG=1":
                    pass
            s.process.terminate()
            while manager.recv(1000) != b"STOPPING=1":
                pass

    def test_bad_addresses_are_refused_with_the_reason(self):
        self.refuses_to_start(2, "--tcp", "nonsense:1:2", says="no address")
        self.refuses_to_start(2, "--tcp", "0.0.0.0:0", says="token_file")
        token = self.write("token", "fifteen letters\n")
        token.chmod(0o600)
        for option in ("--tcp", "--http"):
            self.refuses_to_start(2, option, "0.0.0.0:0", config=f'[serve]\ntoken_file = "{token}"\n', says="15 characters (put at least 16")
        self.refuses_to_start(2, "--socket", "x" * 200, says="name")
        self.refuses_to_start(2, config="[serve]\nhttpp = 4\n", says="httpp")
        self.refuses_to_start(2, config='[serve]\ntcp = "x"\n', says="serve.toml:2:")
        self.refuses_to_start(2, "--period-frames", "1", says="period")
        self.assertFalse((self.dir / "s.sock").exists())
        r = self.run_tool("serve", "-D", "null", env={"XDG_RUNTIME_DIR": "", "RUNTIME_DIRECTORY": ""})
        self.assertEqual(r.returncode, 2)

    def test_a_port_in_use_is_reported_with_its_holder(self):
        s = self.serve("--tcp", "0", "--http", "0")
        me = f"by tactor, process {s.process.pid} (choose another port, or end it)"
        self.refuses_to_start(3, "--socket", self.dir / "b.sock", "--tcp", s.where["tcp"], says=me)
        self.refuses_to_start(3, "--socket", self.dir / "b.sock", "--http", s.where["http"][7:-1], says=me)

    def test_too_few_descriptors_are_reported(self):
        before = resource.getrlimit(resource.RLIMIT_NOFILE)
        few = self.serve_with_descriptors(60, 60)
        self.assertIn("too few descriptors: 60 may be open, and 64 clients need 160", few)
        self.assertNotIn("descriptors", self.serve_with_descriptors(60, before[1]))

    def serve_with_descriptors(self, soft, hard):
        """Returns its messages when it begins with these arguments."""
        p = subprocess.Popen(["prlimit", f"--nofile={soft}:{hard}", TOOL, "serve", "--socket", self.dir / f"{hard}.sock", "-D", "null"],
                             cwd=self.dir, env=self.env, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.assertIn("listening", p.stdout.readline())
        p.terminate()
        return p.communicate(timeout=PATIENCE_S)[1]

    def test_check_reads_the_token(self):
        token = self.write("token", "sixteen letters!\n")
        self.write("tactor.toml", f'[serve]\ntcp = 0\ntoken_file = "{token}"\n')
        token.chmod(0o644)
        r = self.run_tool("check", "-D", "null", "--config", "tactor.toml")
        self.assertEqual(r.returncode, 2)
        self.assertIn("others may read it", r.stderr)

    # Permissions.

    def test_tcp_begins_with_hello(self):
        s = self.serve("--tcp", "0")
        c = s.client(tcp=True)
        self.assertEqual(c.ok("hello")["version"], self.run_tool("--version").stdout.split()[1])
        self.assertEqual(c.ok("status")["clients"], 1)
        for first in (b"POST / HTTP/1.1\r\nHost: x\r\n\r\n", b'{"jsonrpc":"2.0","id":1,"method":"stop"}\n', b"[]\n"):
            c = s.client(tcp=True)
            c.raw(first)
            self.assertIsNone(c.next())

    def test_a_token_is_required(self):
        token = self.write("token", "secret\n")
        token.chmod(0o604)
        config = f'[serve]\ntcp = 0\ntoken_file = "{token}"\n'
        self.refuses_to_start(2, config=config, says="others may read it")
        token.chmod(0o600)
        s = self.serve(config=config)
        c = s.client(tcp=True)
        self.check_error(c.error("hello"), -32003, "token")
        self.check_error(c.error("play", stroke="park2016-1"), -32003)
        self.check_error(c.error("hello", token="secret "), -32003, "token")
        self.assertEqual(c.ok("hello", token="secret")["protocol"], "tactor/1")
        c.ok("status")
        c = s.client(tcp=True)
        for _ in range(3):
            self.check_error(c.error("hello", token="guess"), -32003)
        self.assertIsNone(c.next())
        s.client().ok("status")


if __name__ == "__main__":
    main()
