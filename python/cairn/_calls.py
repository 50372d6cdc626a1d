# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
"""Builds functions and classes: checks and converts arguments by their annotations, and lists options in the help."""

from __future__ import annotations

import functools
import inspect
import json
import operator
import os

import numpy as np

from . import _cairn
from ._cairn import Error


class ArgumentError(Error, TypeError):
    """An Error that is also a TypeError: an argument of a wrong type, an unknown one, or a missing one."""

    __module__ = "cairn"


Error.__module__ = "cairn"
Error.__doc__ = ("Invalid input: what was found, what was expected, and which argument, option or file. "
                 "The command prints the same message.")


# ---- messages ----


def shown(value):
    """A value as shown in messages: 3, 'x', or its type if it is not a plain number or text."""
    text = repr(value) if value is None or isinstance(value, (str, int, float)) else ""
    return text if 0 < len(text) <= 60 else f"a value of type {type(value).__name__}"


def in_words(kind):
    outer, _, inner = kind.partition("[")
    if outer == "Optional":
        return "the name of a file or None" if inner == "PathLike]" else in_words(inner[:-1]) + " or None"
    if outer == "Sequence":
        return "a list, each entry " + in_words(inner[:-1])
    words = {"Dict": "a dict", "Tuple": "a tuple", "int": "a whole number", "float": "a number", "bool": "True or False",
             "PathLike": "a path, str or os.PathLike", "RigLike": "a cairn.Rig, a cairn.Calibration or None"}
    return words.get(outer) or ("a " if kind[0].islower() else "a cairn.") + kind


def refuse(name, value, kind):
    raise ArgumentError(f"{name}: found {shown(value)}, expected {in_words(kind)}")


# ---- arrays ----


def array_like(value, name, expected):
    """The value as a numpy array: an array, or an object such as a PIL image."""
    if not (hasattr(value, "__array__") or hasattr(value, "__array_interface__") or isinstance(value, (memoryview, bytearray))):
        found = "None" if value is None else f"a value of type {type(value).__name__}"
        raise Error(f"{name}: found {found}, expected {expected}")
    return np.asarray(value)


def dense(array, name, fits, expected):
    """The array, or a copy if the pixels of its rows are not contiguous. Raises Error for arrays that do not fit."""
    if fits and 0 in array.shape:
        fits, expected = False, expected + " with at least one pixel"
    elif fits and array.shape[0] * array.shape[1] > 1 << 28:
        fits, expected = False, expected + " of at most 2^28 pixels"
    if not fits:
        raise Error(f"{name}: found an array of shape {array.shape} and type {array.dtype}, expected {expected}")
    return array if _cairn.is_dense(array) else array.copy()


CONVERTED = {"float32": "f", "int32": "iu", "uint8": "b"}  # kinds of other dtypes that are converted


def numbers(value, name, kind):
    expected = f"an array (height, width) of {kind}"
    array = array_like(value, name, expected)
    fits = array.ndim == 2 and (array.dtype == kind or array.dtype.kind in CONVERTED.get(kind, ""))
    return dense(array.astype(kind, copy=False) if fits else array, name, fits, expected)


def hints(value, name):
    expected = "an array (rows, columns, 5) of int16, from hint_objects()"
    array = array_like(value, name, expected)
    fits = array.ndim == 3 and array.shape[2] == 5 and array.dtype == np.int16 and array.size > 0
    return dense(array, name, fits, expected)


def image(value, name, exec, bgr):
    expected = "an image: an array (height, width) or (height, width, 3) of uint8"
    array = array_like(value, name, expected)
    if array.ndim == 3 and array.shape[2] == 1:
        array = array[:, :, 0]
    fits = array.dtype == np.uint8 and (array.ndim == 2 or (array.ndim == 3 and array.shape[2] == 3))
    return _cairn.Picture(dense(array, name, fits, expected), bgr, exec)


def disparities(value, name):
    """An array of disparities, each a hole (NaN, ±inf) or at most ±MAX_DISPARITY."""
    px = numbers(value, name, "float32")
    with np.errstate(invalid="ignore"):
        wild = np.argwhere(np.isfinite(px) & (np.abs(px) > _cairn.MAX_DISPARITY))
    if len(wild):
        y, x = wild[0]
        raise Error(f"{name}: found disparity {px[y, x]:f} px at x {x}, y {y}, expected at most "
                    f"±{_cairn.MAX_DISPARITY:g}, or NaN for a hole")
    return px


def disparity_map(value, name, exec):
    if isinstance(value, _cairn.DisparityMap):
        return value
    return _cairn.external_disparity(DEFAULT, exec, numbers(value, name, "float32"))


def calibration(value, name="rig"):
    if isinstance(value, _cairn.Calibration):
        return value
    if value is None or isinstance(value, _cairn.Rig):
        return _cairn.Calibration(value, None, None, [], None, 0, 0)
    return refuse(name, value, "RigLike")


# ---- other values ----


def whole(value):
    """The value as an int, if it is a whole number of any type, else None."""
    try:
        number = None if isinstance(value, (str, bytes)) else float(value)
    except (TypeError, ValueError, OverflowError):
        return None
    return int(number) if number is not None and number.is_integer() and abs(number) < 2**31 else None


def real(value):
    try:
        return None if isinstance(value, (str, bytes)) else float(value)
    except (TypeError, ValueError):
        return None


def converted(value, name, kind, exec, bgr):
    """Converts an argument for C++. Raises ArgumentError for a wrong type, Error for a wrong value."""
    outer, _, inner = kind.rstrip("]").partition("[")
    again = functools.partial(converted, exec=exec, bgr=bgr)
    if outer == "Optional":
        try:
            return None if value is None else again(value, name, kind[9:-1])
        except ArgumentError:
            return refuse(name, value, kind)
    if outer == "Sequence" and inner in PLAIN:
        value = value.tolist() if isinstance(value, np.ndarray) else value
        if isinstance(value, list) and {*map(type, value)} <= {PLAIN[inner]}:
            return value
    if outer in ("Sequence", "Tuple"):
        kinds = inner.split(", ") if outer == "Tuple" else None
        if isinstance(value, (str, bytes)) or not hasattr(value, "__len__") or (kinds and len(value) != len(kinds)):
            refuse(name, value, kind)
        try:
            return [again(entry, name, kinds[i] if kinds else kind[9:-1]) for i, entry in enumerate(value)]
        except ArgumentError:
            return refuse(name, value, kind)
    if kind == "ImageLike":
        return image(value, name, exec, bgr)
    if kind == "NumbersLike":  # grey levels, or disparities in 1/16 px
        is_16 = isinstance(value, np.ndarray) and value.dtype == np.int16
        return numbers(value, name, "int16") if is_16 else image(value, name, exec, bgr)
    if kind == "HintsLike":
        return None if value is None else hints(value, name)
    if kind == "MaskLike":
        return None if value is None else numbers(value, name, "uint8")
    if kind in ("FloatsLike", "LabelsLike") or outer == "NDArray":
        return numbers(value, name, {"FloatsLike": "float32", "LabelsLike": "int32"}.get(kind) or inner[len("numpy."):])
    if kind == "DisparitiesLike":
        return disparities(value, name)
    if kind == "DisparityLike":
        return disparity_map(value, name, exec)
    if kind == "RigLike":
        return calibration(value, name)
    if kind in ("int", "float"):
        made = whole(value) if kind == "int" else real(value)
        return refuse(name, value, kind) if made is None else made
    if kind == "PathLike":
        return os.fsdecode(value) if isinstance(value, (str, bytes, os.PathLike)) else refuse(name, value, kind)
    types = {"bool": (bool, np.bool_), "str": str, "Dict": dict, **CLASSES}
    if outer in types and not isinstance(value, types[outer]):
        refuse(name, value, kind)
    return value


CLASSES = {}  # of the package, by name
PLAIN = {"int": int, "float": float, "bool": bool}
LIMITS = {"noise_sigma": (np.inf, "0 or more grey levels"), "smoothing_sigma": (5, "0 … 5 px"), "min_confidence": (1, "0 … 1")}


def size_of(parameter, value):
    """(height, width) of a value with one entry per pixel; () for others, and for those that the library compares."""
    arrays = [getattr(value, part, None) for part in ("labels", "disparity_px", "best")]
    value = next((array for array in arrays if isinstance(array, np.ndarray)), value)
    is_other = "MatrixLike" in parameter.annotation or parameter.annotation == "Optional[DisparityLike]" \
        or parameter.annotation == "HintsLike"  # has an entry per cell
    is_image = isinstance(value, (np.ndarray, _cairn.Picture)) and not is_other
    return value.shape[:2] if is_image and len(value.shape) > 1 else ()


def check_sizes(parameters, values):
    """Raises Error unless all have the size of the first. The library compares two images."""
    sized = [(p, size_of(p, values[p.name])) for p in parameters if size_of(p, values[p.name])]
    for other, size in sized[1:]:
        first, expected = sized[0]
        are_images = "ImageLike" in first.annotation and "ImageLike" in other.annotation
        if size != expected and not are_images:
            raise Error(f"{other.name}: is {size[1]}x{size[0]}, expected {expected[1]}x{expected[0]} as {first.name} is")


# ---- functions ----


def bound(title, parameters, takes_options, args, named):
    """The arguments by name, and the options."""
    names = [p.name for p in parameters]
    unnamed = [p.name for p in parameters if p.kind is not p.KEYWORD_ONLY]
    if len(args) > len(unnamed):
        raise ArgumentError(f"{title}: found {len(args)} arguments without a name, expected at most {len(unnamed)}: "
                            + (", ".join(unnamed) or "none"))
    options = {name: value for name, value in named.items() if name not in names}
    if options and not takes_options:
        name = next(iter(options))
        close = _cairn.nearest(name, names)
        hint = f"did you mean '{close}'?" if close else f"expected of these: {', '.join(names) or 'none'}"
        raise ArgumentError(f"{title}: there is no argument '{name}', {hint}")
    values = dict(zip(unnamed, args))
    for p in parameters:
        if p.name in values and p.name in named:
            raise ArgumentError(f"{title}: found argument '{p.name}' twice, expected it once")
        if p.name not in values and p.name not in named and p.default is p.empty:
            raise ArgumentError(f"{title}: found no argument '{p.name}', expected it")
        values.setdefault(p.name, named.get(p.name, p.default))
    return values, options


def checked(function, title="", more=(), groups=None, is_stage=False, run=lambda values, options, result: result):
    """Wraps a function: checks and converts its arguments, and adds its signature and options to its help.

    more: further parameters. groups: groups of its options, a dict for each; for a stage, keywords without a group.
    run: called with the converted values by name, the options, and the result of the function.
    """
    title = title or function.__name__
    signature = inspect.signature(function)
    all_parameters = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD] + list(more)
    parameters = [p for p in all_parameters if p.name != "self"]
    of_options = [p for p in signature.parameters.values() if p.kind is p.VAR_KEYWORD]
    has_groups, takes_options = bool(of_options), bool(of_options) or is_stage
    groups = groups or (GROUPS if has_groups else [])
    is_method = len(parameters) < len(all_parameters)

    @functools.wraps(function)
    def call(*args, **named):
        owner, args = args[:is_method], args[is_method:]
        values, options = bound(title, parameters, takes_options, args, named)
        bgr = converted(values.get("bgr", False), "bgr", "bool", None, False)
        exec = converted(values.get("exec"), "exec", "Optional[Exec]", None, False)
        if exec is None and ("exec" in values or any(p.annotation == "DisparityLike" for p in parameters)):
            exec = _cairn.exec_of_all_processors()
        of_images = exec or getattr(owner[0] if owner else None, "_exec", None) or NO_EXEC
        for p in parameters:
            if p.name in values and p.name not in ("exec", "bgr"):
                values[p.name] = converted(values[p.name], p.name, p.annotation, of_images, bgr)
            if p.name in LIMITS and not (0 <= values[p.name] <= LIMITS[p.name][0] and values[p.name] < np.inf):
                raise Error(f"{p.name}: found {values[p.name]:f}, expected {LIMITS[p.name][1]}")
        if "exec" in values:
            values["exec"] = exec
        check_sizes(parameters, values)
        own = {name: value for name, value in values.items() if name in signature.parameters}
        return run(values, options, function(*owner, **own, **(options if has_groups else {})))

    text = f"{function.__name__}({described(all_parameters, takes_options)} -> {signature.return_annotation}"
    call.__doc__ = f"{text}\n\n{inspect.cleandoc(function.__doc__ or '')}"
    of_stage = [inspect.Parameter("options", inspect.Parameter.VAR_KEYWORD)] * is_stage
    call.__signature__ = signature.replace(parameters=all_parameters + of_options + of_stage)
    call.groups, call.by_group = groups, has_groups
    if takes_options:
        call.__doc__ += options_text(groups, has_groups)
    call.__module__ = "cairn"
    return call


def of_cpp(function):
    """Wraps the C++ function of this name. A body adds checks, and may return other values for it."""
    call = getattr(_cairn, function.__name__)

    def run(values, _, given):
        values.pop("bgr", None)
        return call(*(values.values() if given is None else given))

    return checked(function, run=run)


NO_EXEC = _cairn.Exec(1, "best", "off")  # only for images
# Further parameters of every stage; the last one only with images.
STAGE_NAMED = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, annotation=kind, default=default) for name, kind, default in
               (("config", "Optional[Config]", None), ("exec", "Optional[Exec]", None), ("bgr", "bool", False))]


def described(parameters, takes_options):
    """The text of a signature after the opening bracket."""
    parts = []
    for p in parameters:
        if p.kind is p.KEYWORD_ONLY and "*" not in parts:
            parts.append("*")
        default = "" if p.default is p.empty else f" = {p.default!r}"
        parts.append(p.name if p.name == "self" else f"{p.name}: {p.annotation}{default}")
    return ", ".join(parts + ["**options"] * takes_options) + ")"


def options_text(groups, by_group):
    """A line for each option of the groups, and for config and exec."""
    lines = ["\n\nOptions, a dict for each group of cairn.options(), e.g. match={\"num_disparities\": 64}:" if by_group else
             "\n\nOptions, as keywords (defaults: those of `config`, shown is the preset default):"] if groups else []
    for group in groups:
        lines += ["    " + group] * by_group
        for o in OPTIONS:
            if o.name.startswith(group + "."):
                read = f", read while {o.needs}" if o.needs else ""
                unit = f" {o.unit}" if o.unit else ""
                lines.append(f"    {'    ' * by_group}{o.name.partition('.')[2]} = {o._text}{unit} ({o.range}{read}): {o.help}")
    return "\n".join(lines) + "\n\nconfig: a cairn.Config; None is the preset default. exec: a cairn.Exec; None is all processors."


DEFAULT = _cairn.make_config("default", None, [])
OF_FRAMES = DEFAULT._options()
OPTIONS = OF_FRAMES + getattr(_cairn, "follow_options", list)()
GROUPS, ALL_GROUPS = (list(dict.fromkeys(o.name.partition(".")[0] for o in some)) for some in (OF_FRAMES, OPTIONS))


# ---- classes ----


def brief(value):
    """A value in a repr(): arrays as type and shape, numbers with seven digits, long lists as their length."""
    if isinstance(value, np.ndarray):
        return f"<{value.dtype}{value.shape}>"
    if isinstance(value, float):
        return f"{value:.7g}"
    if not isinstance(value, (tuple, list)):
        return repr(value)
    if len(value) > 8:
        return f"<{len(value)} entries>"
    text = ", ".join(map(brief, value))
    return f"({text})" if isinstance(value, tuple) else f"[{text}]"


def own_repr(self):
    known = {name: getattr(self, name) for name in self._shown}
    known.update(self.as_dict() if self._is_report else {})
    return f"{type(self).__name__}({', '.join(f'{name}={brief(value)}' for name, value in known.items())})"


class Report:
    """The JSON output of the command, `_json`, as attributes, as items and as a dict."""

    def as_dict(self) -> Dict[str, Any]:
        """All entries, as written by the command."""
        return json.loads(self._json() if callable(self._json) else self._json)

    def __getitem__(self, name: str) -> Any:
        """One entry by name."""
        return self.as_dict()[name]

    def __getattr__(self, name: str) -> Any:
        known = {} if name.startswith("_") else self.as_dict()
        if name not in known:
            raise AttributeError(f"{type(self).__name__} has no '{name}'")
        return known[name]


def doc(words, get=None):
    """An attribute of a described class: its help, and a function of the object unless C++ or `_data` has it."""
    return property(get, doc=words)


def describes(cls=None, base=None, groups=None):
    """Decorates a class that describes a class: its doc() attributes and its methods.

    Adds these, and the methods of `base`, to `cls`, a C++ class, whose constructor is then `_start`. Without `cls`,
    attributes are by default those of the object's `_data`. groups: groups of the constructor's options.
    """

    def onto(description):
        target, name = cls or description, description.__name__
        target._shown, target._is_report = vars(description).get("__annotations__", {}), base is Report
        for attribute in target._shown:
            given = vars(description)[attribute]
            get = given.fget or (vars(cls)[attribute].fget if cls else operator.attrgetter("_data." + attribute))
            setattr(target, attribute, property(get, doc=given.__doc__))
        if cls and "__init__" in vars(description):
            cls._start = cls.__init__
        members = {**(vars(base) if base else {}), "__repr__": own_repr, **vars(description)}
        for key, member in members.items():
            if isinstance(member, staticmethod):
                setattr(target, key, staticmethod(checked(member.__func__, f"{name}.{key}")))
            elif inspect.isfunction(member):
                if key == "__init__":
                    member = checked(member, name, groups=groups)
                elif key == "__getitem__" or not key.startswith("_"):
                    member = checked(member, f"{name}.{key}")
                setattr(target, key, member)
        target.__doc__, target.__module__, CLASSES[name] = inspect.cleandoc(description.__doc__), "cairn", target
        return target

    return onto
