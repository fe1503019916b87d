# SPDX-License-Identifier: MIT
# The extension. Not an interface: what is public has its types in the modules around it.
from typing import Any

def __getattr__(name: str) -> Any: ...
