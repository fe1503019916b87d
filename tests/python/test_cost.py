# SPDX-License-Identifier: MIT
"""Costs of Python."""
import ctypes
import subprocess
import sys
import time

import numpy as np
import pytest

import tactor

pytestmark = pytest.mark.unsanitized


def importing(code):
    best = 1e9
    for _ in range(15):
        r = subprocess.run([sys.executable, "-c", f"import time; a = time.process_time(); {code}; print(time.process_time() - a)"],
                           capture_output=True, text=True, check=True)
        best = min(best, float(r.stdout))
    return best


def test_importing_takes_little_time_alone_and_little_more_than_numpy():
    numpy = importing("import numpy")
    both, alone = importing("import numpy, tactor"), importing("import tactor")
    print(f"import numpy {1e3 * numpy:.1f} ms, with tactor {both / numpy:.2f} times that, tactor alone {1e3 * alone:.1f} ms")
    # Aims are 1.5 times and 30 ms; machines differ, and a shared one is noisy: the test holds it near there.
    assert both < 1.7 * numpy
    assert alone < 0.6 * numpy
    assert "numpy" not in subprocess.run([sys.executable, "-c", "import tactor, sys; print([m for m in sys.modules if m == 'numpy'])"],
                                         capture_output=True, text=True, check=True).stdout


def test_planning_and_rendering_take_little_more_than_from_cpp(palm, cpp_library):
    program = ctypes.CDLL(str(cpp_library))
    program.plan_and_render.restype = None
    stroke = tactor.Stroke.preset("park2016-3")

    def in_python():
        return tactor.Score(palm, tactor.plan(palm, stroke)).render()

    def in_cpp():
        return program.plan_and_render(None)
    samples = in_python()
    theirs = np.zeros_like(samples)
    program.plan_and_render(theirs.ctypes.data_as(ctypes.c_void_p))
    assert np.array_equal(samples, theirs)
    least = {in_python: 1e9, in_cpp: 1e9}
    for _ in range(10):  # by turns, so that a busy machine treats both alike
        for work in least:
            for _ in range(50):
                began = time.thread_time()
                work()
                least[work] = min(least[work], time.thread_time() - began)
    ratio = least[in_python] / least[in_cpp]
    print(f"planning and rendering park2016-3 takes {ratio:.3f} times what it takes from C++")
    # The aim is 1.05, which it is within a few per cent of noise.
    assert ratio < 1.2, least
