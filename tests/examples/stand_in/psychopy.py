# SPDX-License-Identifier: MIT
"""A stand-in for the parts of PsychoPy that examples/psychopy uses, by their published interface: its clock is another than
CLOCK_MONOTONIC by a known time, its device manager makes and removes devices, and its participant answers at once."""
import importlib
import inspect
import sys
import time
import types

AHEAD_S = -1234.5


def module(name, **members):
    made = sys.modules[f"psychopy.{name}"] = types.ModuleType(f"psychopy.{name}")
    vars(made).update(members)
    return made


def getTime():
    return time.monotonic() + AHEAD_S


class DeviceManager:
    deviceClasses = []
    aliases = {}
    devices = {}

    @staticmethod
    def registerClassAlias(alias, deviceClass):
        DeviceManager.aliases[alias] = deviceClass

    @staticmethod
    def addDevice(deviceClass, deviceName, *args, **kwargs):
        package, _, name = DeviceManager.aliases.get(deviceClass, deviceClass).rpartition(".")
        DeviceManager.devices[deviceName] = getattr(importlib.import_module(package), name)(*args, **kwargs)
        return DeviceManager.devices[deviceName]

    @staticmethod
    def removeDevice(deviceName):
        DeviceManager.devices.pop(deviceName).close()


class BaseDevice:
    def __init_subclass__(cls, aliases=None):
        name = f"{inspect.getmodule(cls).__name__}.{cls.__name__}"
        for alias in aliases or []:
            DeviceManager.registerClassAlias(alias, name)
        DeviceManager.deviceClasses.append(name)


class Drawn:
    def __init__(self, *_):
        pass

    draw = flip = __init__


def waitKeys(keyList, timeStamped):
    return [(keyList[0], getTime())]


__path__ = []
core = module("core", getTime=getTime)
hardware = module("hardware", DeviceManager=DeviceManager, __path__=[])
module("hardware.base", BaseDevice=BaseDevice)
visual = module("visual", Window=Drawn, TextStim=Drawn)
event = module("event", clearEvents=lambda: None, waitKeys=waitKeys)
