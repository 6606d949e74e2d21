"""Calls the headers' functions: checks and converts arguments, makes answers, raises errors. What there is comes from
api.json, which python/generate.py reads off the headers; nothing here knows a particular function."""
import html
import inspect
import json
import math
import numbers
import os
import re
import sys
import threading
import time
import types
from keyword import iskeyword

import numpy as np

try:
    from ._types import ffi
except ModuleNotFoundError as error:
    if error.name != __package__ + "._types":
        raise
    raise ImportError("riddle is not built: run python/build in its repository, or pip install .") from None

_here = os.path.dirname(os.path.abspath(__file__))
lib = ffi.dlopen(os.path.join(_here, "_riddle.so"))
with open(os.path.join(_here, "api.json"), encoding="utf-8") as _file:
    api = json.load(_file)
for _number, _name in enumerate(api["layout"]):
    if ffi.sizeof(_name) != lib.riddle_layout(_number):
        raise ImportError(f"the library and its description differ in {_name}: build both anew")

DTYPES = {"double": np.float64, "float": np.float32, "int": np.intc, "unsigned": np.uintc, "unsigned int": np.uintc,
          "size_t": np.uintp,
          "ptrdiff_t": np.intp, "int32_t": np.int32, "uint32_t": np.uint32, "int64_t": np.int64, "uint64_t": np.uint64,
          "uint8_t": np.uint8, "unsigned char": np.uint8, "_Bool": np.bool_}
LARGEST = 1 << 31  # elements of one array
_types_of = {name: (lower, kind) for lower, h in api["headers"].items() for name, kind in h["types"].items()}
_classes = {}
_shapes = api["shapes"]


class Error(RuntimeError):
    """A status other than ok. status: its number; name: DEM_BAD_ARGUMENT ...; text: its meaning; field: what was wrong;
    hint: which arguments look wrong, or all of them; particle: its id; materials: two of them; None where that is not
    known."""

    particle = materials = None

    def __init__(self, status, name, text, field=None, hint=None):
        super().__init__(f"{text} ({name})" + "".join(f": {more}" for more in (field, hint) if more))
        self.status, self.name, self.text, self.field, self.hint = status, name, text, field, hint

    def __reduce__(self):
        return type(self), (self.status, self.name, self.text, self.field, self.hint), dict(self.__dict__)


class Result(types.SimpleNamespace):
    """Several answers of one function, by their names."""

    def __repr__(self):
        return f"Result({', '.join(f'{name}={short(value)}' for name, value in vars(self).items())})"


def short(value):
    """A value in a line: long arrays and structures by their shape and name."""
    if isinstance(value, np.ndarray):
        return str(value.tolist()) if value.size <= 4 else f"<array {value.shape} of {value.dtype}>"
    if isinstance(value, list):
        return (f"<list of {len(value)}>" if len(value) > 4 or any(isinstance(v, (list, Structure)) for v in value)
                else repr(value))
    if isinstance(value, Structure):
        text = repr(value)
        return text if len(text) < 80 else f"<{value._name}>"
    if isinstance(value, float):
        return f"{value:.6g}"
    text = repr(value)
    return text if len(text) < 80 else text[:76] + " ..."


def _base(c_type):
    """The type of one number or structure: that of what a pointer or an array has."""
    return re.sub(r"\bconst\b|\bstruct\b|\*|\[.*", "", c_type).strip()


_fields = {}


def _fields_of(c_type):
    """The fields of a structure of C by name."""
    if c_type not in _fields:
        _fields[c_type] = dict(c_type.fields or ())
    return _fields[c_type]


def _named(c_type):
    return c_type.cname[7:] if c_type.cname.startswith("struct ") else c_type.cname


_TIMES = "times need a unit: divide by it, as in t / numpy.timedelta64(1, 's')"


def number(c_type, value, what):
    """A number for C, of a type that is no array and no text; whole where C's type is."""
    # most often
    if type(value) is float and c_type == "double" or type(value) is int and c_type not in ("double", "float"):
        return value
    if isinstance(value, np.ndarray) and value.ndim == 0 and not np.ma.isMaskedArray(value):
        value = value[()]
    if isinstance(value, np.generic):
        if value.dtype.kind in "mM":
            raise TypeError(f"{what}: {_TIMES}")
        value = float(value) if value.dtype.kind == "f" else value.item()
    if not isinstance(value, numbers.Real):
        raise TypeError(f"{what}: a number is needed, not {type(value).__name__}")
    if c_type in ("double", "float"):
        return float(value)
    if not isinstance(value, numbers.Integral) and (not math.isfinite(value) or value != int(value)):
        raise TypeError(f"{what}: a whole number is needed, not {value}")
    return int(value)


def _parts(n, value, what, names=""):
    """The n parts of a sequence; text, a set and another number of parts are refused."""
    if type(value) not in (tuple, list):
        wrong = (isinstance(value, (str, bytes, bytearray, dict, set, frozenset)) or not hasattr(value, "__len__")
                 or np.ndim(value) == 0)
        given = value.tolist() if type(value) is np.ndarray and value.dtype.kind in "iuf" else value
    else:
        wrong, given = False, value
    if wrong or len(given) != n:
        raise TypeError(f"{what}: {n} numbers are needed{names}, not {value!r}")
    return given


_PLAIN = frozenset((int, float))


def vector(n, value, what):
    """n finite numbers as a tuple."""
    if type(value) is tuple and len(value) == n and _PLAIN.issuperset(map(type, value)):
        made = value
    else:
        made = tuple([number("double", v, what) for v in _parts(n, value, what)])
    if not all(map(math.isfinite, made)):
        raise ValueError(f"{what}: finite numbers are needed, not {value!r}")
    return made


def _array(value, dtype, what):
    if np.ma.isMaskedArray(value) and np.ma.getmaskarray(value).any():
        raise ValueError(f"{what}: entries are masked; leave them out, as in a[~numpy.ma.getmaskarray(a)].data, and "
                         "what belongs to them")
    try:
        given = np.asarray(value)
        if given.dtype.kind in "mM":
            raise TypeError(_TIMES)
        if (given.dtype.kind not in "biufO" or given.dtype.kind == "O"
            and any(isinstance(v, (str, bytes, np.datetime64, np.timedelta64)) for v in given.flat)):
            raise TypeError("text, complex numbers and records are none")
        with np.errstate(all="ignore"):
            made = np.asarray(given, order="C").astype(dtype, copy=False)
    except (TypeError, ValueError, OverflowError) as error:
        raise TypeError(f"{what}: numbers are needed, not {type(value).__name__} ({error})") from None
    if made.dtype.kind in "iu" and not np.array_equal(made.ravel(), given.ravel()):
        raise ValueError(f"{what}: whole numbers from {np.iinfo(dtype).min} to {np.iinfo(dtype).max} are needed")
    return made


def _changed(value, dtype, what):
    """An array of the caller's that C writes into."""
    if not (isinstance(value, np.ndarray) and not np.ma.isMaskedArray(value) and value.dtype == dtype
            and value.flags.c_contiguous and value.flags.writeable):
        raise TypeError(f"{what}: a writable contiguous numpy array of {np.dtype(dtype)} is needed; it is changed")
    return value


def _writes(name, about):
    """Does C write into the array that a field of a structure points to?"""
    return "const" not in about["type"] and not _shapes.get(name, "").startswith("read")


def _fits(array, dims):
    """Has an array this shape, or are its numbers given flat, row by row?"""
    return array.shape == tuple(dims) or array.ndim == 1 and array.size == int(np.prod(dims))


def _struct(c_type, value, what):
    """A new structure of C from its numbers: as many as it has fields."""
    fields = _fields_of(c_type)
    if any(field.type.kind not in ("primitive", "enum") for field in fields.values()):
        raise TypeError(f"{what}: a {_named(c_type)} is needed, not {type(value).__name__}")
    given = _parts(len(fields), value, what, f" ({', '.join(fields)})")
    return ffi.new(ffi.getctype(c_type, "*"),
                   tuple([number(field.type.cname, v, f"{what}.{name}")
                          for (name, field), v in zip(fields.items(), given)]))


class Shape:
    """A line of shapes.txt."""

    def __init__(self, text, constants):
        self.inout = text.startswith("inout")
        self.optional = text.startswith("optional")
        rest = re.sub(r"^(inout|optional|read)\b", "", text).strip()
        self.scalar = rest == "scalar"
        self.any = rest == "any"
        self.checked = rest[len("checked by "):] if rest.startswith("checked by ") else None
        self.dims = None
        self.bare = []
        if rest.startswith("["):
            inner = re.sub(r"\bdef\b", "definition", rest[1:-1])
            self.dims = compile(f"({inner},)", text, "eval")
            self.bare = [d.strip() for d in inner.split(",")]
        self.constants = constants

    def of(self, names, what):
        scope = dict(self.constants)
        scope.update(names)
        try:
            dims = tuple(int(d) for d in eval(self.dims, {"__builtins__": {}}, scope))
        except (TypeError, AttributeError, IndexError, NameError, OverflowError):
            raise ValueError(f"{what}: its length cannot be told from the other arguments") from None
        size = 1
        for d in dims:
            size *= d
            if d < 0 or size > LARGEST:
                raise ValueError(f"{what}: no array of shape {dims}")
        return dims


def _shape(key, constants):
    text = _shapes.get(key)
    return Shape(text, constants) if text is not None else None


_constants = {}
for _lower, _h in api["headers"].items():
    _upper = _lower.upper() + "_"
    _values = {name[len(_upper):]: value for name, value in _h["constants"].items()}
    _values.update({name[len(_upper):]: getattr(lib, name) for name in _h["enumerators"]})
    _constants[_lower] = _values


def held(values):
    """All that these values refer to now: arrays, functions, structures. Kept by what C makes of the values and points
    to them."""
    found, waiting = {}, list(values)
    while waiting:
        value = waiting.pop()
        if value is None or id(value) in found:
            continue
        found[id(value)] = value
        if isinstance(value, Structure):
            waiting += [value._kept, value._parent]
        elif isinstance(value, dict):
            waiting += value.values()
        elif isinstance(value, (list, tuple)):
            waiting += value
    return list(found.values())


def _copied(kept):
    return {name: _copied(value) if isinstance(value, dict) else value for name, value in kept.items()}


_pointing = {}


def _points(c_type):
    """Whether a type of C has pointers, to data or to functions."""
    if c_type.kind == "array":
        return _points(c_type.item)
    if c_type.kind != "struct":
        return c_type.kind in ("pointer", "function")
    if c_type.cname not in _pointing:
        _pointing[c_type.cname] = any(_points(field.type) for field in _fields_of(c_type).values())
    return _pointing[c_type.cname]


class _Memory:
    """A part of a structure's memory, for an array that keeps the structure."""

    def __init__(self, owner, c, dtype, dims):
        self.owner = owner
        self.__array_interface__ = {"version": 3, "data": (int(ffi.cast("uintptr_t", c)), False),
                                    "typestr": np.dtype(dtype).str, "shape": tuple(dims)}


class Structure:
    """A structure of the headers: the same fields. Made with its defaults where the header has some; fields by
    keyword."""

    _name = None
    _parent = None  # the structure that this one is a part of

    def __init__(self, **fields):
        default = _default_of(self._name)
        object.__setattr__(self, "_c", ffi.new(f"{self._name} *"))
        object.__setattr__(self, "_kept", {})  # what its pointers point to, by field; that of its parts in dictionaries
        if default:
            self._c[0] = getattr(lib, default)()
        # arrays tell lengths; a length that is given is kept, and compared when the structure is used
        for name, value in sorted(fields.items(), key=lambda item: item[0] in _lengths_of(self._name)):
            setattr(self, name, value)

    @classmethod
    def _of(cls, c, parent=None, part=None):
        """A structure around C's: a copy of a value, or a part of another one, under whose name that keeps what the
        part points to."""
        made = cls.__new__(cls)
        if parent is None:
            c, value = ffi.new(f"{cls._name} *"), c
            c[0] = value
        object.__setattr__(made, "_c", c)
        object.__setattr__(made, "_parent", parent)
        object.__setattr__(made, "_kept", {} if part is None or not _points(ffi.typeof(c).item)
                           else parent._kept.setdefault(part, {}))
        return made

    def _become(self, other):
        """Takes the fields of another one, and keeps what they point to."""
        kept = _copied(other._kept)
        self._c[0] = other._c[0]
        self._kept.clear()
        self._kept.update(kept)

    def __getattr__(self, name):
        field = _types_of[self._name][1]["fields"].get(name)
        if field is None or "__" in name:
            raise AttributeError(f"{self._name} has no field {name}; it has {', '.join(self._fields())}")
        if name in self._kept:
            return self._kept[name]
        c_type = _fields_of(ffi.typeof(self._c).item)[name].type
        value = getattr(self._c, name)
        if c_type.kind == "struct":
            part = ffi.addressof(self._c[0], name)
            return _classes[_named(c_type)]._of(part, self, f"{name} part") if _named(c_type) in _classes else part
        if c_type.kind == "array":
            return self._array_field(name, c_type, value)
        if c_type.kind == "pointer":
            return (None if value == ffi.NULL else ffi.string(value).decode()
                    if c_type.cname in ("char *", "const char *") else value)
        return value

    def _array_field(self, name, c_type, value):
        item, dims = c_type.item, [c_type.length]
        while item.kind == "array":
            dims.append(item.length)
            item = item.item
        if item.kind == "struct":
            def parts(*at):
                if len(at) < len(dims):
                    return [parts(*at, k) for k in range(dims[len(at)])]
                return _classes[_named(item)]._of(ffi.addressof(self._c[0], name, *at), self, f"{name} part {at}")
            return parts()
        if item.cname == "char":
            return ffi.string(value).decode(errors="replace")
        return np.asarray(_Memory(self, value, DTYPES.get(item.cname, np.intc), dims))

    def __setattr__(self, name, value):
        about = _types_of[self._name][1]["fields"].get(name)
        if about is None or "__" in name:
            raise AttributeError(f"{self._name} has no field {name}; it has {', '.join(self._fields())}")
        c_type = _fields_of(ffi.typeof(self._c).item)[name].type
        what = f"{self._name}.{name}"
        if isinstance(value, Structure) and c_type.kind == "struct":
            if _named(c_type) != value._name:
                raise TypeError(f"{what}: a {_named(c_type)} is needed, not a {value._name}")
            getattr(self, name)._become(value)
        elif c_type.kind == "struct":
            setattr(self._c, name, _struct(c_type, value, what)[0])
            self._kept.pop(f"{name} part", None)
        elif c_type.kind == "array":
            view = getattr(self, name)
            if isinstance(view, str) or isinstance(view, list) and isinstance(view[0], list):
                raise TypeError(f"{what} cannot be set")
            if isinstance(view, list):
                self._set_parts(view, value, what)
            else:
                array = _array(value, view.dtype, what)
                if array.ndim > 0 and not _fits(array, view.shape):
                    raise ValueError(f"{what}: shape {array.shape} given, {view.shape} needed")
                view[...] = array.reshape(view.shape) if array.ndim > 0 else array
        elif c_type.kind in ("pointer", "function"):
            self._set_pointer(name, about, c_type, value, what)
        else:
            try:
                setattr(self._c, name, number(c_type.cname, value, what))
            except OverflowError as error:
                raise TypeError(f"{what}: {error}") from None

    def _set_parts(self, parts, value, what):
        """The first elements of an array of structures: structures, or the numbers of each."""
        if isinstance(value, (str, bytes, dict, set)) or not hasattr(value, "__len__") or len(value) > len(parts):
            raise TypeError(f"{what}: a list of at most {len(parts)} {parts[0]._name} is needed"
                            + (f", not of {len(value)}" if isinstance(value, (list, tuple, np.ndarray)) else ""))
        made = []
        for k, new in enumerate(value):
            if isinstance(new, Structure) and new._name != parts[k]._name:
                raise TypeError(f"{what}[{k}]: a {parts[k]._name} is needed, not a {new._name}")
            made.append(new if isinstance(new, Structure)
                        else parts[k]._of(_struct(ffi.typeof(parts[k]._c).item, new, f"{what}[{k}]")[0]))
        for part, new in zip(parts, made):
            part._become(new)

    def _set_pointer(self, name, about, c_type, value, what):
        if _shapes.get(what, "").startswith("C only"):
            raise TypeError(f"{what} cannot be set from Python")
        if value is None:
            setattr(self._c, name, ffi.NULL)
            self._kept.pop(name, None)
        elif c_type.kind == "function":
            made = _callback(c_type, value, what)
            setattr(self._c, name, made)
            self._kept[name] = made
        elif about.get("pointer") in DTYPES:
            array = (_changed if _writes(what, about) else _array)(value, DTYPES[about["pointer"]], what)
            setattr(self._c, name, ffi.cast(c_type, ffi.from_buffer(array)))
            self._kept[name] = array
            shape = _shape(f"{self._name}.{name}", {})
            for axis, part in enumerate(shape.bare if shape else ()):
                if part in _lengths_of(self._name) and array.ndim == len(shape.bare):
                    setattr(self._c, part, array.shape[axis])
        elif (isinstance(value, (list, tuple)) and c_type.kind == "pointer" and _named(c_type.item) in _classes
              and _shape(what, {})):
            self._set_structures(name, c_type, value, what)
        elif isinstance(value, Structure) and _named(c_type.item) in ("void", value._name):
            setattr(self._c, name, ffi.cast(c_type, value._c))
            self._kept[name] = value
        else:
            raise TypeError(f"{what} cannot be set from Python")

    def _set_structures(self, name, c_type, value, what):
        """An array of structures: copies, which the field then lists."""
        item = _named(c_type.item)
        for k, new in enumerate(value):
            if not isinstance(new, Structure) or new._name != item:
                raise TypeError(f"{what}[{k}]: a {item} is needed, not a {type(new).__name__}")
        array = ffi.new(f"{item}[]", max(len(value), 1))
        parts = [_classes[item]._of(array + k, self, f"{name} part {k}") for k in range(len(value))]
        for part, new in zip(parts, value):
            part._become(new)
        setattr(self._c, name, array)
        self._kept[name], self._kept[f"{name} array"] = parts, array
        for part in _shape(what, {}).bare:
            if part in _lengths_of(self._name):
                setattr(self._c, part, len(value))

    def _fields(self):
        return [name for name in _types_of[self._name][1]["fields"] if "__" not in name]

    def _check_arrays(self, scope=None, prefix=None, above=()):
        """Are the arrays that fields point to as long as the structure says?"""
        lower, kind = _types_of[self._name]
        for name, about in kind["fields"].items():
            if isinstance(self._kept.get(name), list):
                dims = _shape(f"{self._name}.{name}",
                              _constants[lower]).of({n: getattr(self, n) for n in self._fields() if n != name},
                                                    f"{self._name}.{name}")
                if len(self._kept[name]) != dims[0]:
                    raise ValueError(f"{self._name}.{name}: a list of {len(self._kept[name])}, but {dims[0]} is needed")
                for part in self._kept[name]:
                    part._check_arrays(above=above)
            if about.get("pointer") not in DTYPES:
                continue
            shape = (_shape(f"{prefix}.{name}" if prefix else "", _constants[lower])
                     or _shape(f"{self._name}.{name}", _constants[lower]))
            if shape is None or shape.dims is None:
                continue
            names = {n: getattr(self, n) for n in self._fields() if n != name}
            names.update(scope or {})
            dims = shape.of(names, f"{self._name}.{name}")
            array = self._kept.get(name)
            if array is None and (getattr(self._c, name) == ffi.NULL) and (shape.optional or 0 in dims):
                continue
            if array is None or not _fits(array, dims):
                raise ValueError(f"{self._name}.{name}: {'not set' if array is None else array.shape}, but "
                                 f"{dims} is needed")
            if _writes(f"{self._name}.{name}", about):
                _changed(array, array.dtype, f"{self._name}.{name}")
        for name, field in _fields_of(ffi.typeof(self._c).item).items():
            if field.type.kind == "struct" and _named(field.type) in _classes and _points(field.type):
                getattr(self, name)._check_arrays(above=above)
        for kept in (*self._kept.values(), *self._kept.get("arguments", ())):
            if isinstance(kept, Structure) and not any(kept is other for other in above):
                kept._check_arrays(above=(*above, kept))

    def __dir__(self):
        return self._fields()

    def __repr__(self):
        return f"{self._name}({', '.join(f'{n}={short(getattr(self, n))}' for n in self._fields())})"

    def _repr_html_(self):
        """A table of the fields, with the header's comments."""
        about = _types_of[self._name][1]["fields"]
        rows = "".join(f"<tr><td>{n}</td><td>{html.escape(short(getattr(self, n)))}</td><td "
                       f"style='text-align:left'>{html.escape(about[n]['doc'])}</td></tr>" for n in self._fields())
        return f"<table><caption>{self._name}</caption>{rows}</table>"

    def __iter__(self):
        return iter([getattr(self, n) for n in self._fields()])

    def __copy__(self):
        made = type(self)._of(self._c[0])
        made._kept.update(_copied(self._kept))
        return made

    def __reduce__(self):
        raise TypeError(f"{self._name} cannot be pickled; keep its fields")


def _default_of(name):
    """The function without arguments that makes the defaults of a structure."""
    lower = _types_of[name][0]
    for function, about in api["headers"][lower]["functions"].items():
        if about["returns"] == name and not about["parameters"] and "default" in function:
            return about["symbol"]
    return None


_lengths = {}


def _lengths_of(name):
    """The fields of a structure that the length of an array tells."""
    if name not in _lengths:
        kind = _types_of[name][1]["fields"]
        _lengths[name] = {part for field in kind for shape in [_shape(f"{name}.{field}", {})] if shape
                          for part in shape.bare
                          if part in kind and number_type(kind[part]["type"])}
    return _lengths[name]


def number_type(c_type):
    return c_type in DTYPES and c_type not in ("double", "float", "_Bool")


_thread = threading.local()
_open = []  # calls of C in progress, of all threads


class Call:
    """Around a call of C: the first exception in a Python function that C calls ends what can be ended, and is raised
    when C returns. The handles that C works on cannot be freed meanwhile."""

    def __init__(self, handles=()):
        self.error, self.handles = None, handles

    def __enter__(self):
        try:
            _thread.calls.append(self)
        except AttributeError:
            _thread.calls = [self]
        _open.append(self)
        for handle in self.handles:
            handle._users.append(self)
        return self

    def __exit__(self, kind, error, trace):
        _thread.calls.remove(self)
        _open.remove(self)
        for handle in self.handles:
            handle._users.remove(self)
        if self.error is not None:
            raise self.error


def _call_now():
    """The call of C in which this thread is; a thread that C made belongs to the newest one."""
    calls = getattr(_thread, "calls", None) or _open
    return calls[-1] if calls else None


def _note(kind, error, trace):
    call = _call_now()
    if call is None:
        sys.excepthook(kind, error, trace)
    elif call.error is None:
        call.error = error


def _callback(c_type, value, what):
    """A C function for a Python one, or the address of one of the headers' own. When it has failed, C gets NaN, or what
    stops it."""
    symbol = getattr(value, "c_symbol", None)
    if symbol:
        return ffi.cast(c_type, ffi.addressof(lib, symbol))
    if not callable(value):
        raise TypeError(f"{what}: a function is needed, not {type(value).__name__}")
    kinds, result = c_type.args, c_type.result
    if len(kinds) == 4 and kinds[2].kind == "function":
        return ffi.callback(c_type, _all_tasks(value, what), onerror=_note)
    failure = (np.nan if result.cname in ("double", "float") else 1 if what.endswith("stop") else None
               if result.kind in ("void", "pointer") else 0)
    numbers_out = [k for k, kind in enumerate(kinds) if kind.cname == "double *"
                   and any(before.cname == "double" for before in kinds[:k])]

    def called(*arguments):
        call = _call_now()
        if call is None or call.error is None:
            try:
                returned = value(*arguments)
                return None if result.kind == "void" else returned
            except BaseException as error:
                _note(type(error), error, error.__traceback__)
        for k in numbers_out:
            arguments[k][0] = np.nan
        for argument in arguments:
            if isinstance(argument, ffi.CData) and ffi.typeof(argument).cname.endswith("dem_pose *"):
                argument.shift.x = np.nan
        return failure if result.kind != "pointer" else ffi.NULL

    return ffi.callback(c_type, called, onerror=_note, **({} if failure is None else {"error": failure}))


def _all_tasks(value, what):
    """A function that runs tasks: those that it has not run when it fails, or forgets, are run here, for C goes on."""
    def called(user, tasks, task, context):
        done, call = set(), _call_now()
        if call is not None and call.error is not None:
            for k in range(tasks):
                task(context, k)
            return

        def once(context, index):
            task(context, index)
            done.add(index)

        try:
            value(user, tasks, once, context)
        finally:
            left = [k for k in range(tasks) if k not in done]
            for k in left:
                task(context, k)
        if left:
            raise RuntimeError(f"{what}: the function returned before all tasks had been run")

    return called


class Handle:
    """Something that only C looks into: a simulation, a model. It is freed with its object, or by free()."""

    _name = None
    _free = None
    _c = None

    def __init__(self):
        lower = _types_of[self._name][0]
        raise TypeError(f"a {self._name} is made by {lower}.{type(self).__name__}(definition)")

    @classmethod
    def _new(cls):
        """One that C will fill."""
        made = object.__new__(cls)
        made._begin()
        return made

    def _begin(self):
        self._memory = ffi.new("char[]", getattr(lib, f"size_of_{self._name}")())
        self._c = ffi.cast(f"{self._name} *", self._memory)
        self._keep, self._users = {}, []

    def __repr__(self):
        return f"<{self._name}" + (", freed>" if self._c is None else ">")

    def __copy__(self):
        raise TypeError(f"a {self._name} cannot be copied or pickled: make another one in the same way")

    def __deepcopy__(self, memo):
        return self.__copy__()

    def __reduce__(self):
        return self.__copy__()

    def _hold(self, values):
        """Keeps, until it is freed, what C may point to: what these values refer to now."""
        self._keep.update((id(value), value) for value in held(values))

    @property
    def _alive(self):
        if self._c is None:
            raise ValueError(f"this {self._name} has been freed")
        return self._c

    def free(self):
        if self._c is not None and self._users:
            raise RuntimeError(f"this {self._name} cannot be freed while it runs")
        if self._c is not None and self._free:
            self._before_free()
            getattr(lib, self._free)(self._c)
        self._c = None
        self._keep = {}

    def _before_free(self):
        pass

    def __del__(self):
        if self._c is not None:
            self.free()


class Function:
    """One function of a header."""

    def __init__(self, lower, name, about):
        self.lower, self.name, self.about = lower, name, about
        self.symbol = about["symbol"]
        self.c_function = getattr(lib, self.symbol)
        self.constants = _constants[lower]
        self.parameters = [Parameter(self, p) for p in about["parameters"]]
        self.returns = _base(about["returns"])
        role = re.fullmatch(r"index(?: or (\w+))?", _shapes.get(name, ""))
        self.index, self.refusal = bool(role), role and role[1] and self.constants[role[1]]
        self.status = self.returns == f"{lower}_status" and not name.endswith("_text")
        self.inferred = about["lengths"]
        self.visible = [p for p in self.parameters if p.about["role"] in ("given", "optional")]
        self.guarded = any(p.changes or p.about["function"] or p.structure and _points(ffi.typeof(p.type))
                           for p in self.parameters)
        self.defined = any(p.c_name == "def" and p.pointer for p in self.parameters)
        steps, _, pieces = _shapes.get(name, "").partition(" ")
        self.pieces = [p.name for p in self.parameters].index(steps) if pieces == "in pieces" else None

    def __call__(self, *args, **keywords):
        given = self._bind(args, keywords)
        names, converted, keep = {}, {}, []
        for p in self.parameters:
            if p.name in given and not p.pointer:
                names[p.name] = given[p.name]
                if isinstance(given[p.name], Structure):
                    keep.append((p.name, given[p.name]))
        for p in self.parameters:
            if p.name in given and p.pointer:
                converted[p.name] = p.take(given[p.name], keep)
                names[p.name] = given[p.name]
        for parameter, (array, axis, more) in self.inferred.items():
            shape = np.shape(keep_of(keep, array)) if keep_of(keep, array) is not None else None
            names[parameter] = 0 if shape is None or len(shape) <= axis else shape[axis] - more
        for p in self.parameters:
            if p.name in given and p.pointer:
                p.check(given[p.name], keep_of(keep, p.name), names)
        answers, arguments, field = [], [], None
        for p in self.parameters:
            if p.field:
                field = ffi.new("const char **")
                arguments.append(field)
            elif p.made:
                c, answer = p.make(names, keep)
                arguments.append(c)
                answers.append((p.name, answer))
            elif p.hidden:
                arguments.append(ffi.NULL)
            elif p.name in converted:
                arguments.append(converted[p.name])
            elif p.pointer:
                arguments.append(ffi.NULL)
            else:
                arguments.append(p.number(names[p.name]))
        value = self._run(arguments, [value for _, value in keep if isinstance(value, Handle)])
        for p in self.parameters:
            if p.name in converted and p.structure and p.shape and p.shape.inout and p.shape.dims:
                for k, item in enumerate(keep_of(keep, p.name)):  # C has changed copies
                    item._c[0] = converted[p.name][k]
        functions = [c for p, c in zip(self.parameters, arguments) if p.about["function"] and c is not ffi.NULL]
        for handle in [value for _, value in (*keep, *answers) if isinstance(value, Handle)] if functions else ():
            handle._keep.update((id(c), c) for c in functions)  # it may call them later
        if self.defined:  # a simulation copies its definition
            for handle in [value for _, value in keep if isinstance(value, Handle)]:
                handle._hold([keep_of(keep, "definition")])
        return self._answer(value, answers, field, [value for _, value in keep], given)

    def _run(self, arguments, handles):
        """Calls C; where shapes.txt allows it in pieces of a tenth of a second, between which Ctrl-C and exceptions of
        functions end it."""
        if not self.guarded:
            return self.c_function(*arguments)
        if self.pieces is None:
            with Call(handles):
                return self.c_function(*arguments)
        left, piece, value = arguments[self.pieces], 1, 0
        while True:
            begun, arguments[self.pieces] = time.monotonic(), min(left, piece)
            with Call(handles):
                value = self.c_function(*arguments)
            left -= piece
            if value != 0 or left <= 0:
                return value
            took = time.monotonic() - begun
            piece = 2 * piece if took < 0.05 else max(piece // 2, 1) if took > 0.2 else piece

    def _bind(self, args, keywords):
        if len(args) > len(self.visible):
            raise TypeError(f"{self.name}: at most {len(self.visible)} arguments: "
                            f"{', '.join(p.name for p in self.visible)}")
        given = {p.name: value for p, value in zip(self.visible, args)}
        for name, value in keywords.items():
            if name in given or name not in {p.name for p in self.visible}:
                raise TypeError(f"{self.name}: {name} is given twice or unknown; it takes "
                                f"{', '.join(p.name for p in self.visible)}")
            given[name] = value
        for p in self.visible:
            if p.name not in given:
                if not p.optional:
                    raise TypeError(f"{self.name}: {p.name} is missing; it takes "
                                    f"{', '.join(q.name for q in self.visible)}")
            elif given[p.name] is None and p.pointer:
                if not p.optional:
                    raise TypeError(f"{self.name}: {p.name} must not be None")
                del given[p.name]
        return given

    def _answer(self, value, answers, field, given, arguments):
        if self.status and value != 0 or self.index and value < 0:
            status = int(value) if self.status else self.refusal or -int(value)
            field = None if field is None or field[0] == ffi.NULL else ffi.string(field[0]).decode()
            changes = (self.lower, status) == ("dem", lib.DEM_BAD_ARGUMENT) and any(p.changes for p in self.visible)
            raise status_error(self.lower, status, field,
                               of_field(field, arguments) or wrong_arguments(arguments, self.about["doc"], changes))
        made = [(name, answer() if callable(answer) else answer) for name, answer in answers]
        if not self.status and self.about["returns"] != "void":
            made.insert(0, ("value", self._value(value)))
        for _, answer in made:  # C may have put pointers to its arguments into them
            for structure in answer if isinstance(answer, list) else [answer]:
                if isinstance(structure, Structure) and given and _points(ffi.typeof(structure._c).item):
                    structure._kept["arguments"] = held(given)
        if len(made) <= 1:
            return made[0][1] if made else None
        return Result(**dict(made))

    def _value(self, value):
        if isinstance(value, ffi.CData):
            kind = ffi.typeof(value)
            if kind.kind == "struct":
                return _classes[_named(kind)]._of(value)
            if kind.cname in ("char *", "const char *"):
                return ffi.string(value).decode() if value != ffi.NULL else None
        return value


def keep_of(keep, name):
    for kept, value in keep:
        if kept == name:
            return value
    return None


def of_field(field, arguments):
    """'is -1.0' for a field of a definition that C has named; of an array of structures all that are in use."""
    for definition in arguments.values() if field else ():
        value, used = definition, None
        try:
            for part in re.findall(r"\w+", field):
                if part.isdigit():
                    value = value[int(part)]
                elif isinstance(value, list):
                    value = [getattr(one, part) for one in value[:used]]
                else:
                    value, used = getattr(value, part), getattr(value, part + "s", None)
        except (AttributeError, IndexError, TypeError):
            continue
        if not isinstance(value, Structure):
            return f"is {short(np.asarray(value) if isinstance(value, list) else value)}"
    return None


_EMPTY = {"axis", "normal", "direction", "right"}  # vectors that must not be zero


def wrong_arguments(arguments, doc="", changes=False):
    """Which arguments look wrong, for an error of C that names none. Where none does: all of them, after what the world
    says about a call that was to change it."""
    world = next((v for v in arguments.values() if isinstance(v, Handle) and v._name == "dem_world"), None)
    said = ffi.string(lib.dem_error_text(world._alive)).decode() if changes and world is not None else ""
    found = []
    for name, value in arguments.items():
        if isinstance(value, Handle):
            continue
        if isinstance(value, Structure):
            found += [f"{name}.{problem}" for problem in wrong_fields(value)]
        elif callable(value) or value is None:
            continue
        else:
            problem = wrong_value(name, value, world, doc)
            if problem:
                found.append(f"{name} = {short(np.asarray(value) if isinstance(value, list) else value)}: {problem}")
    given = ", ".join(f"{name} = {short(np.asarray(v) if isinstance(v, list) else v)}"
                      for name, v in arguments.items() if not isinstance(v, Handle))
    return "; ".join(found) or "; ".join(filter(None, (said, given)))


def wrong_fields(structure):
    """Fields that are not finite, or outside the range of their comment. Where the comment says more of NaN than that
    it is the default, NaN means something."""
    for name, about in _types_of[structure._name][1]["fields"].items():
        if "__" in name or about.get("pointer") or about["type"] not in ("double", "float"):
            continue
        value = getattr(structure, name)
        said = re.sub(r"\bdefault\b[^;]*", "", about["doc"], flags=re.I)
        if math.isnan(value) and not re.search(r"\bnan\b", said, re.I):
            yield f"{name} = nan: not a number"
        elif re.search(r"^[^:;]*\] > 0", about["doc"]) and value <= 0.0:
            yield f"{name} = {value:.6g}: must be above 0"
        elif re.search(r"^[^:;]*\] >= 0", about["doc"]) and value < 0.0:
            yield f"{name} = {value:.6g}: must not be below 0"


def wrong_value(name, value, world, doc):
    """What is wrong with one argument, or None."""
    try:
        array = np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        return None
    if not np.isfinite(array).all() and not re.search(rf"\b{name}\b[^.(]*(\bNaN\b|\(infinite\b)", doc):
        return "not finite"
    if name in _EMPTY and array.shape == (3,) and not array.any():
        return "a direction of length 0"
    lengths = ("radius", "length", "diameter", "diameters", "mass", "inertia", "aperture", "wire", "dt")
    rates = ("duration", "rate", "frequency", "damping")
    if name in rates and (array < 0.0).any():
        return "must not be below 0"
    if (name in lengths or re.search(rf"\b{name}\b[^.;,]*> 0", doc)) and (array <= 0.0).any():
        return "must be above 0"
    if world is None or array.ndim:
        return None
    if name == "material" and math.isnan(lib.riddle_density(world._alive, int(array))):
        return "the world has no such material"
    if name == "wall" and not 0 <= array < lib.riddle_walls(world._alive):
        return f"the world has {lib.riddle_walls(world._alive)} walls" + (f", 0 to {lib.riddle_walls(world._alive) - 1}"
                                                                          if lib.riddle_walls(world._alive) else "")
    if name == "i" and not lib.riddle_is_present(world._alive, int(array)):
        return "there is no such particle" + ("" if 0 <= array < lib.riddle_count(world._alive)
                                              else f": there are {lib.riddle_count(world._alive)}")
    return None


def status_error(lower, status, field=None, hint=None):
    names = api["headers"][lower]["enums"].get(f"{lower}_status", [])
    name = names[status] if 0 <= status < len(names) else str(status)
    text = getattr(lib, api["headers"][lower]["functions"][f"{lower}_status_text"]["symbol"])(status)
    return Error(status, name, ffi.string(text).decode(), field, hint)


class Parameter:
    def __init__(self, function, about):
        self.function, self.about = function, about
        self.name = about["called"]
        self.pointer = about["pointer"]
        self.callback = about["callback"]
        self.type = base = about["base"]
        self.c_name = about["name"]
        self.shape = _shape(f"{function.name}.{self.c_name}", function.constants)
        self.opaque = base in _types_of and _types_of[base][1]["opaque"]
        self.structure = base in _types_of and not self.opaque
        self.changes = self.opaque and "const" not in about["type"]
        self.field = about["deep"] and base == "char"  # names what is wrong: field, reason
        self.hidden, self.made, self.optional = (about["role"] == role for role in ("hidden", "made", "optional"))
        self.dtype = DTYPES.get(base)

    def number(self, value):
        c_type = self.about["type"]
        if self.structure:
            if isinstance(value, Structure):
                if value._name != self.type:
                    raise TypeError(f"{self.function.name}: {self.name}: a {self.type} is needed, not a {value._name}")
                return value._c[0]
            return _struct(ffi.typeof(self.type), value, f"{self.function.name}: {self.name}")[0]
        if self.about["function"]:
            return ffi.NULL if value is None else _callback(ffi.typeof(c_type), value, self.name)
        return number(self.type, value, f"{self.function.name}: {self.name}")

    def take(self, value, keep):
        """Converts what the caller gave for a pointer."""
        what = f"{self.function.name}: {self.name}"
        if self.opaque:
            if not isinstance(value, Handle) or value._name != self.type:
                raise TypeError(f"{what}: a {self.type} is needed, not {type(value).__name__}")
            keep.append((self.name, value))
            return value._alive
        if self.structure and not (self.shape and self.shape.dims):
            if not isinstance(value, Structure) or value._name != self.type:
                raise TypeError(f"{what}: a {self.type} is needed, not {type(value).__name__}")
            keep.append((self.name, value))
            return value._c
        if self.structure:
            items = list(value)
            for item in items:
                if not isinstance(item, Structure) or item._name != self.type:
                    raise TypeError(f"{what}: a list of {self.type} is needed")
            c = ffi.new(f"{self.type}[]", max(len(items), 1))
            for k, item in enumerate(items):
                c[k] = item._c[0]
            keep.append((self.name, items))
            return c
        if self.dtype is None:
            raise TypeError(f"{what} cannot be given from Python")
        if self.shape is not None and self.shape.inout:
            array = _changed(value, self.dtype, what)
        else:
            array = _array(value, self.dtype, what)
        keep.append((self.name, array))
        return ffi.cast(f"{self.type} *", ffi.from_buffer(array)) if array.size else ffi.NULL

    def check(self, value, kept, names):
        what = f"{self.function.name}: {self.name}"
        if self.structure:
            for item in kept if isinstance(kept, list) else [kept]:
                item._check_arrays(names, f"{self.function.name}.{self.c_name}")
            if isinstance(kept, list) and self.shape.of(names, what) != (len(kept),):
                raise ValueError(f"{what}: {len(kept)} given, {self.shape.of(names, what)[0]} needed")
            if self.shape is not None and self.shape.checked:
                status = getattr(lib, self.shape.checked)(kept._c)
                if status != 0:
                    raise status_error(self.function.lower, status, self.name)
        elif self.shape is not None and self.shape.dims:
            dims = self.shape.of(names, what)
            if not _fits(kept, dims):
                raise ValueError(f"{what}: shape {kept.shape} given, {dims} needed")

    def make(self, names, keep):
        """Room for an answer: C's pointer, and how to make Python's value of it."""
        what = f"{self.function.name}: {self.name}"
        if self.opaque:
            handle = _classes[self.type]._new()
            handle._hold(value for _, value in keep)  # C may point to them
            return handle._c, handle
        if self.structure:
            count = self.shape.of(names, what)[0] if self.shape and self.shape.dims else None
            c = ffi.new(f"{self.type}[]", max(count or 1, 1))
            cls = _classes[self.type]
            return c, (lambda: cls._of(c[0])) if count is None else (lambda: [cls._of(c[k]) for k in range(count)])
        if self.shape is None or self.dtype is None:
            raise TypeError(f"{what} cannot be made in Python")
        if self.shape.scalar:
            c = ffi.new(f"{self.type} *")
            return c, lambda: c[0]
        array = np.zeros(self.shape.of(names, what), dtype=self.dtype)
        return (ffi.cast(f"{self.type} *", ffi.from_buffer(array)) if array.size else ffi.new(f"{self.type} *")), array


def ffi_of_law():
    """Declarations of a user's library."""
    import cffi
    made = cffi.FFI()
    made.cdef("size_t law_world_size(void); int law_run(void *world, double duration);"
              "int law_set(const char *name, double value); double law_get(const char *name); void law_forget(const "
              "void *world);")
    return made


def _signature(function, method=False):
    """Names, in their order, and what may be left out, for help() and completion."""
    kind, parameters, required = inspect.Parameter.POSITIONAL_OR_KEYWORD, [], False
    for p in reversed(function.visible):
        required = required or not p.optional
        parameters.insert(0, inspect.Parameter(p.name, kind, default=inspect.Parameter.empty if required else None))
    return inspect.Signature([inspect.Parameter("self", kind), *parameters[1:]] if method else parameters)


def _python_function(function):
    def call(*args, **keywords):
        return function(*args, **keywords)

    call.__name__ = function.name[len(function.lower) + 1:] or function.name
    call.__name__ += "_" * iskeyword(call.__name__)  # classifier_for is classifier.for_
    call.__qualname__ = call.__name__
    call.__signature__ = _signature(function)
    call.method_signature = _signature(function, True)
    answers = [p.name for p in function.parameters if p.made]
    call.__doc__ = (f"{call.__name__}({', '.join(p.name + ('=None' if p.optional else '') for p in function.visible)})"
                    + (f" -> {', '.join(answers)}" if answers else "")
                    + f"\n\n{function.about['doc']}\n\nC: {function.about['signature']}")
    call.c_symbol = function.symbol
    call.c_name = function.name
    return call


def _method(function, handle):
    """A function of a handle, its first parameter, as a method."""
    def call(self, *args, **keywords):
        return function(self, *args, **keywords)

    prefix = handle if function.c_name.startswith(handle + "_") else handle.split("_")[0]
    name = function.c_name[len(prefix) + 1:]
    call.__name__ = call.__qualname__ = name + "_" * iskeyword(name)
    call.__doc__, call.__signature__, call.c_name = function.__doc__, function.method_signature, function.c_name
    return call


def handle_of(about):
    """The opaque type whose method a function is: that of its first parameter."""
    first = about["parameters"][0] if about["parameters"] else None
    return (first["base"] if first and first["pointer"] and first["base"] in _types_of
            and _types_of[first["base"]][1]["opaque"] else None)


class Hook:
    """A function of the headers that is given to a definition, such as a kernel: C calls it with the definition's
    data."""

    def __init__(self, about, name):
        self.c_symbol, self.c_name, self.__name__ = about["symbol"], name, name
        self.__doc__ = f"{about['doc']}\n\nC: {about['signature']}"

    def __call__(self, *args, **keywords):
        raise TypeError(f"{self.__name__}: give it to a definition; C calls it with the definition's data")


def in_python(name):
    return not _shapes.get(name, "").startswith("C only")


def _handle_class(name, lower, makers, module):
    """The class of an opaque type, which its _init makes: granulation_sim -> granulation.Sim(definition)."""
    short_name = name[len(lower) + 1:].capitalize()

    def make(cls, *args, **keywords):
        made = makers[0](*args, **keywords)
        handle = (made if isinstance(made, Handle)
                  else next(value for value in vars(made).values() if isinstance(value, Handle)))
        handle.__class__ = cls
        return handle

    cls = type(short_name, (Handle,),
               {"_name": name, "__module__": module.__name__, "__init__": lambda self, *args, **keywords: None})
    functions = api["headers"][lower]["functions"]
    cls._free = next((free for free in (f"{name}_free", f"{lower}_free") if free in functions), None)
    if makers:
        cls.__new__ = make
        cls.__doc__, cls.__signature__ = makers[0].__doc__, makers[0].__signature__
    return cls


def fill(module, lower, known=()):
    """Puts a header's functions, structures and constants into a module, without their prefix. known: classes of opaque
    types that it has."""
    header = api["headers"][lower]
    prefix = lower + "_"
    module._functions, methods, names = {}, {}, []

    def put(name, value):
        setattr(module, name, value)
        names.append(name)

    for name, value in _constants[lower].items():
        if not name.startswith("_"):
            put(name, value)
    for name, kind in header["types"].items():
        if not kind["opaque"]:
            called = "def_" if name == prefix + "def" else name[len(prefix):] or name
            lines = [f"{field} ({about['type']}): {about['doc']}" for field, about in kind["fields"].items()
                     if "__" not in field]
            _classes[name] = type(called, (Structure,),
                                  {"_name": name, "__module__": module.__name__,
                                   "__doc__": f"{name}\n\n" + "\n".join(lines)})
            fields, keyword = [f for f in kind["fields"] if "__" not in f and f.isidentifier()
                               and not iskeyword(f)], inspect.Parameter.KEYWORD_ONLY
            _classes[name].__signature__ = inspect.Signature([inspect.Parameter(field, keyword, default=...)
                                                              for field in fields])
            put(called, _classes[name])
    for name, about in header["functions"].items():
        if in_python(name):
            made = Hook(about, name) if about["hook"] else _python_function(Function(lower, name, about))
            module._functions[name] = made
            if handle_of(about):
                methods.setdefault(handle_of(about), []).append(made)
            else:
                put(made.__name__[len(prefix):] if isinstance(made, Hook) else made.__name__, made)
    for name, kind in header["types"].items():
        if kind["opaque"] and name not in known:
            own = methods.get(name, [])
            cls = _classes[name] = _handle_class(name, lower, [f for f in own if f.c_name.endswith("_init")], module)
            for function in own:
                if not function.c_name.endswith(("_init", "_free")):
                    made = _method(function, name)
                    setattr(cls, made.__name__, made)
            put(cls.__name__, cls)
    for name, cls in dict(known).items():
        _classes[name] = cls
    module.__all__ = [*getattr(module, "__all__", ()), *dict.fromkeys(names)]
    module.__dir__ = lambda: module.__all__
