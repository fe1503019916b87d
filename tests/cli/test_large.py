# SPDX-License-Identifier: MIT
"""Endless input, or input of the largest size: bounded memory, and time that grows only with the size."""
import os
import subprocess
import unittest

from harness import PATIENCE_S, SANITIZED, TOOL, ToolTest, main

MB = 1 << 20


class Large(ToolTest):
    def write_pieces(self, name, pieces):
        """Writes in pieces: this process's peak memory counts as the peak of its children."""
        with open(self.dir / name, "wb") as f:
            for piece in pieces:
                f.write(piece)
        return self.dir / name

    def cost(self, *args, stdin=subprocess.DEVNULL):
        """Returns exit status, output, peak memory in MB and processor time in seconds."""
        with open(self.dir / "said", "w+b") as said:
            p = subprocess.Popen([TOOL, *args], stdin=stdin, stdout=subprocess.DEVNULL, stderr=said, cwd=self.dir,
                                 env=self.env)
            try:
                _, status, usage = os.wait4(p.pid, 0)
            except BaseException:
                p.kill()
                raise
            said.seek(0)
            return os.waitstatus_to_exitcode(status), said.read().decode(), usage.ru_maxrss / 1024, usage.ru_utime + usage.ru_stime

    @unittest.skipIf(SANITIZED, "a sanitizer's own memory is not bounded")
    def test_endless_standard_input_is_refused_in_bounded_memory(self):
        with open("/dev/zero", "rb") as endless:
            status, said, mb, _ = self.cost("plan", "-", stdin=endless)
        self.assertEqual((status, said), (2, "tactor: standard input: longer than 512 MB (is it the right file?)\n"))
        self.assertLess(mb, 600)

    @unittest.skipIf(SANITIZED, "a sanitizer's own memory is not bounded")
    def test_endless_lists_in_a_line_are_refused_in_bounded_memory(self):
        self.write_pieces("values.csv", (b"0," * (MB // 2) for _ in range(64)))
        status, said, mb, _ = self.cost("plan", "values.csv")
        self.assertEqual(status, 2, said)
        self.assertIn("values.csv:1:2001: more than 1000 values in a line", said)
        self.assertLess(mb, 128)

    @unittest.skipIf(SANITIZED, "a sanitizer's own memory is not bounded")
    def test_a_million_timed_points_need_memory_for_their_text_and_themselves(self):
        def lines():
            yield b"t_s,x_mm,y_mm\n"
            for i in range(1_000_000):
                yield b"%d.%03d,%d,%d.%020d\n" % (i // 1000, i % 1000, i % 40, i % 31, 7)

        path = self.write_pieces("long.csv", lines())
        with open(path, "rb") as f:
            status, said, mb, _ = self.cost("plan", "-", "--format", "csv", stdin=f)
        self.assertEqual((status, said), (0, ""))
        self.assertLess(mb, path.stat().st_size / MB + 32 + 32)  # points of 32 bytes; the tool itself

    def test_two_lists_along_a_path_cost_time_by_their_length(self):
        def seconds(points):
            parts = [i / (points - 1) for i in range(points)]
            speeds = ", ".join(f"[{p:.9f}, {20 + 80 * (i * 7919 % points) / points:.3f}]" for i, p in enumerate(parts))
            carriers = ", ".join(f"[{p:.9f}, {100 + 200 * (i * 104729 % points) / points:.3f}]" for i, p in enumerate(parts))
            self.write("two.toml", f'[[stroke]]\npath = "M 0 20 L 40 20"\neasing = "minimum-jerk"\n'
                                   f"speed_mm_s = [{speeds}]\ncarrier_profile = [{carriers}]\n")
            status, said, _, used = self.cost("render", "two.toml", "-o", "two.wav")
            self.assertEqual((status, said), (0, ""))
            return used

        # Eight times as many: quadratic time would be 64 times.
        self.assertLess(seconds(80_000), 24 * seconds(10_000))

    @unittest.skipIf(SANITIZED, "a sanitizer's own memory is not bounded")
    def test_a_burst_of_an_hour_needs_a_tenth_of_a_kilobyte(self):
        def peak_kb(seconds):
            status, said, mb, _ = self.cost("render", "park2016-1", "--duration", str(seconds), "-o", "-")
            self.assertEqual(status, 0, said)
            return mb * 1024

        bursts = 3600 / 0.07
        self.assertLess((peak_kb(3600) - peak_kb(1)) * 1024, 100 * bursts)

    def test_a_text_for_a_tree_has_a_lower_limit(self):
        self.write_pieces("big.svg", [b"<svg>", *[b" " * MB] * 48])
        self.assertIn("big.svg: longer than 48 MB (simplify the drawing)", self.refused(2, "plan", "big.svg").stderr)
        self.write_pieces("big.toml", [b"#", *[b"#" * MB] * 48])
        self.refused(2, "plan", "big.toml")

    def test_the_time_for_shapes_grows_with_their_number(self):
        def time_for(shapes):
            self.write("drawing.svg", "<svg>\n" + "".join(f"<path d='M {i % 40} 0 L 40 {i % 40}'/>\n"
                                                          for i in range(shapes)) + "</svg>\n")
            status, said, _, seconds = self.cost("plan", "drawing.svg", "--format", "csv")
            self.assertEqual(status, 0, said)
            return seconds

        # Both together: the kernel shares their time out now and then. The largest: the others had luck.
        few = max(time_for(1500) for _ in range(3))
        # Ten times as many took seventy times as long when each was looked up in the file.
        self.assertLess(time_for(15000), 25 * few)

    def test_a_pipe_is_read_like_a_file(self):
        os.mkfifo(self.dir / "pipe")
        p = subprocess.Popen([TOOL, "plan", "pipe", "--format", "csv"], stdout=subprocess.PIPE, cwd=self.dir, env=self.env)
        with open(self.dir / "pipe", "w") as pipe:
            pipe.write("t_s,x_mm,y_mm\n0,0,0\n1,40,40\n")
        out, _ = p.communicate(timeout=PATIENCE_S)
        self.assertEqual(p.returncode, 0)
        self.write("plain.csv", "t_s,x_mm,y_mm\n0,0,0\n1,40,40\n")
        self.assertEqual(out.decode(), self.ok("plan", "plain.csv", "--format", "csv").stdout)


if __name__ == "__main__":
    main()
