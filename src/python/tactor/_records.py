# SPDX-License-Identifier: MIT
"""What a record of a plan may say: the tool's schema."""
from __future__ import annotations

import functools
import json
import os
import typing as _t

from tactor._errors import InputError

_SCHEMA = os.path.join(os.path.dirname(__file__), "tactor-plan-1.schema.json")


def check_keys(text: str, name: str) -> None:
    """Refuses keys that no plan has; `text` is JSON that was read as a plan, `name` stands for it in messages."""
    record = json.loads(text)
    plans = record.get("plans")
    for plan in plans if isinstance(plans, list) else [record]:
        _check(plan, _schema(), "", name)


@functools.lru_cache(None)
def _schema() -> dict[str, _t.Any]:
    with open(_SCHEMA, encoding="utf-8") as file:
        return json.load(file)  # type: ignore[no-any-return]


def _check(value: _t.Any, schema: dict[str, _t.Any], place: str, name: str) -> None:
    if isinstance(value, list):
        for i, entry in enumerate(value):
            _check(entry, schema.get("items", {}), f"{place}[{i}]", name)
        return
    known = schema.get("properties")
    if not isinstance(value, dict) or known is None:
        return
    for key, entry in value.items():
        at = f"{place}.{key}" if place else key
        if key not in known:
            raise InputError(f"{name}: {at}", "no plan has this key", _nearest(key, known), file=name, field=at)
        _check(entry, known[key], at, name)


def _nearest(key: str, known: _t.Iterable[str]) -> str:
    import difflib
    near = difflib.get_close_matches(key, known, 1)
    return f"did you mean '{near[0]}'?" if near else "see tactor-json(5)"
