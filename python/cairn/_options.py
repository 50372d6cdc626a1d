# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Lists options and sets them by keyword. Names, defaults, units, ranges and help come from the library."""

from __future__ import annotations

import os

from . import _cairn
from ._calls import DEFAULT, GROUPS, OPTIONS, ArgumentError, checked, describes, doc, of_cpp, shown
from ._cairn import Error

NAMES = {o.name for o in OPTIONS}


def option_text(value):
    """A value in the syntax of the command line."""
    if hasattr(value, "dtype") and hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float) and value.is_integer() and abs(value) <= 2**53:
        return str(int(value))  # 64.0 is accepted as 64
    return str(value)


def option_value(option):
    types = {"bool": lambda text: text == "true", "int": int, "float": float}
    return types.get(option.type, str)(option._text)


def refuse_keyword(name):
    """Raises ArgumentError for a keyword that is not a group: an option without its group, or a misspelling."""
    text = f"there is no keyword argument '{name}'"
    for option in OPTIONS:
        if option.name.endswith("." + name):
            raise ArgumentError(f"{text}, did you mean {option.group}={{'{name}': …}}?")
    close = _cairn.nearest(name, [*GROUPS, "rig", "preset", "config", "exec", "bgr"])
    raise ArgumentError(text + (f", did you mean '{close}'?" if close else "; cairn.options() lists the options"))


def settings_of(groups, known=GROUPS):
    """Converts a dict per group to a list of (full name, text), one per option."""
    settings = []
    for group, values in groups.items():
        if group not in known and not (isinstance(values, dict) and values):
            refuse_keyword(group)
        if not isinstance(values, dict):
            raise ArgumentError(f'options {group}: found {shown(values)}, expected a dict such as match={{"num_disparities": 64}}')
        settings += [(f"{group}.{name}", option_text(value)) for name, value in values.items()]
    return settings


def base_of(config, preset):
    """The Config to start from or None, and the file name or None."""
    if isinstance(config, _cairn.Config):
        if preset not in ("default", config.preset):
            raise Error(f"preset: found '{preset}' together with a config of preset '{config.preset}', expected one of the two")
        return config, None
    if config is not None and not isinstance(config, (str, os.PathLike)):
        raise ArgumentError(f"config: found {shown(config)}, expected a cairn.Config, the name of a file, or None")
    return None, config and os.fspath(config)


def config_of(config, preset, groups):
    """The Config from preset, file and keywords, e.g. match={"num_disparities": 64}; later ones win, as in the
    command."""
    base, file = base_of(config, preset)
    settings = settings_of(groups)
    return base._with(settings, []) if base else _cairn.make_config(preset, file, settings)


def flat_config(config, groups, options):
    """The Config with options of these groups, given as keywords without the group name."""
    settings = []
    for name, value in options.items():
        if not groups:
            raise ArgumentError(f"there is no keyword argument '{name}'")
        of = next((group for group in groups if f"{group}.{name}" in NAMES), groups[0])
        settings.append((f"{of}.{name}", option_text(value)))
    return (config or DEFAULT)._with(settings, groups)


def values_by_group(options):
    groups = {}
    for option in options:
        groups.setdefault(option.group, {})[option.name.partition(".")[2]] = option.default
    return groups


@describes(_cairn.Option)
class Option:
    """One option of the method, named as in the command and on the reference page."""

    name: str = doc("group and name, e.g. 'match.window_size'")
    group: str = doc("stage that it belongs to, e.g. 'match'", lambda self: self.name.partition(".")[0])
    type: str = doc("'int', 'float', 'bool' or 'choice'")
    default: Any = doc("value in the given preset", option_value)
    unit: str = doc("unit; may be empty")
    range: str = doc("accepted values, e.g. '3 … 31, odd', '−1 = off, 0 … 64', 'sad|ssd|…'")
    help: str = doc("short description")
    needs: str = doc("condition under which it is read, e.g. 'match.method=window' or 'ground.source!=off'; '' = always")
    active: bool = doc("True if the given preset reads it")


@describes(_cairn.Config)
class Config:
    """The values of all options. They come from a preset, then a file (in the format of `cairn config`), then keywords;
    later ones win:
        cairn.Config('paper', match={'window_size': 11})
    Raises cairn.Error for an unknown name, a value out of range, or an option without effect."""

    preset: str = doc("name of the preset it started from")

    def __init__(self, preset: str = "default", file: Optional[PathLike] = None, **options) -> None:
        """preset: one of preset_names(). file: name of a configuration file, or None. options: a dict for each group of
        options()."""
        self._start(preset, file, settings_of(options))

    def __getitem__(self, name: str) -> Any:
        """The value of an option by its full name, e.g. 'match.window_size'."""
        found = [option_value(option) for option in self._options() if option.name == name]
        return found[0] if found else self._with([(name, "")], [])  # raises, with the nearest name

    def as_dict(self) -> Dict[str, Dict[str, Any]]:
        """The values of all options that are read, a dict per group. Config(**config.as_dict()) equals this Config."""
        return values_by_group(option for option in self._options() if option.active)

    def yaml(self) -> str:
        """The text of a configuration file: all options that are read, each with a comment."""
        return self._yaml()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _cairn.Config) and self._yaml() == other._yaml()

    def __repr__(self):
        base = {option.name: option._text for option in options(self.preset)}
        changed = values_by_group(o for o in self._options() if o.active and o._text != base[o.name])
        return f"Config({', '.join([repr(self.preset), *(f'{group}={values}' for group, values in changed.items())])})"


@describes(_cairn.Exec)
class Exec:
    """Execution settings: threads, instruction set, device and a pool of image buffers. They never change a result."""

    threads: int = doc("number of threads, including the caller's; 1 or more")
    target: str = doc("instruction set of the kernels")
    device: str = doc("graphics processor that matches, as it was asked for; 'off': none")
    heap_allocations: int = doc("number of image buffers that the pool has allocated on the heap")

    def __init__(self, threads: int = 0, target: str = "best", device: str = "off") -> None:
        """threads: 0 = one per processor. target: 'best' or one of supported_targets(). device: 'off', 'auto', or the
        number or name of a graphics processor that `cairn info` lists. What it cannot do, the processor does, with a
        warning."""
        self._start(threads, target, device)

    def __getstate__(self):
        return self.threads, self.target, self.device

    def __setstate__(self, state):
        self.__init__(*state)


@checked
def options(preset: str = "default") -> List[Option]:
    """All options with their values in a preset, in the order of the stages."""
    return _cairn.make_config(preset, None, [])._options()


@of_cpp
def preset_names() -> List[str]:
    """The names of the presets: 'default', 'paper'."""


@of_cpp
def compiled_targets() -> List[str]:
    """The instruction sets in this build, slowest first."""


@of_cpp
def supported_targets() -> List[str]:
    """The instruction sets in this build that the processor supports, slowest first."""
