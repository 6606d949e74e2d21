#!/usr/bin/env python3
"""Makes the binding from the headers: declarations for cffi, their comments as docstrings, and the two C files of the
shared library.

    python/generate.py FOLDER      writes api.json, _types.py, shared_dem.c, shared_rest.c and the stubs (.pyi) there

What cannot be read off a declaration, how long an array is and what is an answer, stands in shapes.txt. A pointer to
numbers without a line there is an error, so that a new function cannot be forgotten.
"""
import json
import keyword
import os
import re
import shlex
import subprocess
import sys

from pycparser import c_ast, c_generator, c_parser

import stubs

here = os.path.dirname(os.path.abspath(__file__))
root = os.path.dirname(here)
HEADERS = ["dem.h", "liquid_bridge.h", "screen_models.h", "blocking.h", "granulation.h", "classifier.h", "filtration.h"]
# Structures that only C looks into: Python holds them by a pointer.
OPAQUE = {"dem_world", "granulation_sim", "granulation_balance", "granulation_montecarlo", "classifier_model",
          "filtration_fluid", "filtration_bed"}
SYSTEM = ["int8_t", "uint8_t", "int16_t", "uint16_t", "int32_t", "uint32_t", "int64_t", "uint64_t", "size_t",
          "ptrdiff_t"]


def prefix_of(text):
    return re.search(r"^#ifndef ([A-Z][A-Z_]*)_API$", text, re.M)[1]


def preprocessed(header, prefix):
    """Declarations of a header without comments, and the numbers that it defines."""
    source = f'#define {prefix}_API extern\n#include "{header}"\n'
    cpp = [*shlex.split(os.environ.get("CC", "cc")), "-E", "-I", root, "-x", "c", "-std=c99", "-O0",
           "-D__attribute__(x)=", "-D__restrict__=", "-D__extension__=", "-"]
    text = subprocess.run(cpp, input=source, capture_output=True, text=True, check=True).stdout
    lines, inside = [], False
    for line in text.split("\n"):
        marker = re.match(r'# \d+ "([^"]*)"', line)
        if marker:
            inside = os.path.basename(marker[1]) == header
        elif inside and not line.startswith("#"):
            lines.append(line)
    macros = subprocess.run([*cpp[:-1], "-dM", "-"], input=source, capture_output=True, text=True, check=True).stdout
    constants = {}
    for name, value in re.findall(rf"^#define ({prefix}_[A-Z0-9_]*[A-Z0-9]) (.+)$", macros, re.M):
        if "__" not in name and re.fullmatch(r"\(?-?\d[\w.+-]*\)?", value.strip()):
            constants[name] = (float(value.strip("() fuUlL")) if re.search(r"[.eE]", value) and "x" not in value
                               else int(value.strip("() uUlL"), 0))
    return "\n".join(lines), constants


def syntax_tree(text):
    prelude = "".join(f"typedef int {name};\n" for name in SYSTEM) + "typedef int __builtin_va_list;\n"
    return c_parser.CParser().parse(prelude + text)


def is_own(name, lower):
    return name is not None and (name == lower or name.startswith(lower + "_"))


def is_public(name, lower):
    return is_own(name, lower) and "__" not in name


def plain(text):
    """A comment as a docstring."""
    return re.sub(r"\s+", " ", text.replace("*/", "").replace("/*", "")).strip()


def comments(header_text, lower):
    """Comments of functions, by name, and of fields, by structure and name."""
    functions, fields = {}, {}
    lines = header_text.split("\n")
    for number, line in enumerate(lines):
        found = re.match(rf"(?:static inline|[A-Z_]+(?:_API|_INLINE)) [^(]*[ *]({lower}_[a-z0-9_]+)\(", line)
        if found and found[1] not in functions:
            after = re.search(r"/\*(.*)", line)
            block, k = [], number - 1
            while k >= 0 and re.match(r"(?:static inline|[A-Z_]+_API|[A-Z_]+_INLINE) .*;", lines[k]):
                k -= 1
            if k >= 0 and lines[k].rstrip().endswith("*/"):
                while k >= 0:
                    block.insert(0, lines[k])
                    if "/*" in lines[k]:
                        break
                    k -= 1
            text = plain(" ".join(block) if not re.search(r"\*/.*\S", " ".join(block)[:-2] if block else "") else "")
            functions[found[1]] = plain(after[1]) if after else text if not text.startswith("---") else ""
    for match in re.finditer(r"typedef struct (\w+) \{\n(.*?)\n\} (\w+);", header_text, re.S):
        own, pending = {}, None
        for line in match[2].split("\n"):
            parts = re.match(r"\s*([^/]*?);\s*(?:/\*(.*))?$", line)
            if parts and parts[1].strip():
                names = re.findall(r"\*?\s*(\w+)(?:\[[^\]]*\])*\s*(?:,|$)", parts[1].split(" ", 1)[-1])
                text = parts[2] or ""
                for name in names:
                    own[name] = text
                pending = names if parts[2] is not None and "*/" not in parts[2] else None
            elif pending:
                for name in pending:
                    own[name] += " " + line.strip()
                pending = None if "*/" in line else pending
        fields[match[3]] = {name: plain(text) for name, text in own.items()}
    return functions, fields


def numbers_pointed_to(kind):
    """double, int, ... if the type is a pointer to (or an array of) numbers, and whether they are constant."""
    if not isinstance(kind, (c_ast.PtrDecl, c_ast.ArrayDecl)) or not isinstance(kind.type, c_ast.TypeDecl):
        return None, False
    target = kind.type.type
    return (" ".join(target.names) if isinstance(target, c_ast.IdentifierType) else None), "const" in kind.type.quals


class Header:
    def __init__(self, file):
        with open(os.path.join(root, file), encoding="utf-8") as opened:
            self.text = opened.read()
        self.file, self.upper = file, prefix_of(self.text)
        self.lower = self.upper.lower()
        text, self.constants = preprocessed(file, self.upper)
        self.tree = syntax_tree(text)
        self.about, self.field_about = comments(self.text, self.lower)
        self.declarations, self.enumerators, self.types, self.functions, self.enums = [], [], {}, {}, {}
        self.generator = c_generator.CGenerator()
        for node in self.tree.ext:
            self.take(node)

    def take(self, node):
        declaration = node.decl if isinstance(node, c_ast.FuncDef) else node
        name = declaration.name
        if isinstance(node, c_ast.Typedef) and is_own(name, self.lower):
            self.take_type(node)
        elif (isinstance(declaration, c_ast.Decl) and isinstance(declaration.type, c_ast.FuncDecl)
              and is_public(name, self.lower) and name not in self.functions):
            self.take_function(declaration)
        elif isinstance(declaration, c_ast.Decl) and isinstance(declaration.type, c_ast.Enum):
            self.take_enum(declaration.type)

    def take_enum(self, enum):
        if enum.values and all(is_own(e.name.lower(), self.lower) for e in enum.values.enumerators):
            self.declarations.append(self.generator.visit(enum) + ";")
            self.enumerators += [e.name for e in enum.values.enumerators if is_public(e.name.lower(), self.lower)]

    def take_type(self, node):
        name, kind = node.name, node.type
        inner = kind.type if isinstance(kind, c_ast.TypeDecl) else None
        if name in OPAQUE:
            self.declarations.append(f"typedef struct {name} {name};")
            self.types[name] = {"opaque": True, "doc": "", "fields": {}}
            return
        if (isinstance(inner, c_ast.Struct) and inner.decls is None
            and any(d.startswith(f"typedef struct {inner.name} ") for d in self.declarations)):
            return
        self.declarations.append(self.generator.visit(node) + ";")
        if not is_public(name, self.lower):
            return
        if isinstance(inner, c_ast.Struct) and inner.decls:
            about = self.field_about.get(name, {})
            fields = {}
            for field in inner.decls:
                target, constant = numbers_pointed_to(field.type)
                kind = self.generator.visit(field.type)
                kind = kind.replace(f" {field.name}", "").replace(f"*{field.name}", "*")
                fields[field.name] = {"type": kind, "doc": about.get(field.name, "")}
                if isinstance(field.type, c_ast.PtrDecl) and target:
                    fields[field.name]["pointer"] = target
            self.types[name] = {"opaque": False, "fields": fields, "doc": ""}
        elif isinstance(inner, c_ast.Enum) and inner.values:
            self.enums[name] = [e.name for e in inner.values.enumerators]
            self.enumerators += self.enums[name]

    def take_function(self, declaration):
        function = declaration.type
        parameters = []
        for p in function.args.params if function.args else []:
            if isinstance(p, (c_ast.Typename, c_ast.EllipsisParam)):
                continue
            target, constant = numbers_pointed_to(p.type)
            pointer = isinstance(p.type, (c_ast.PtrDecl, c_ast.ArrayDecl))
            depth2 = pointer and isinstance(p.type.type, c_ast.PtrDecl)
            callback = pointer and isinstance(p.type.type, c_ast.FuncDecl)
            parameters.append({"name": p.name, "pointer": pointer and not callback, "target": target, "const": constant,
                               "deep": depth2, "callback": callback,
                               "type": self.generator.visit(p.type), "text": self.generator.visit(p)})
        returns = self.generator.visit(function.type)
        returns = re.sub(rf"\b{declaration.name}\b", "",
                         returns).replace("static", "").replace("inline", "").replace("extern", "").strip()
        inline = "inline" in (declaration.funcspec or [])
        arguments = ", ".join(self.generator.visit(p) for p in (function.args.params if function.args else []))
        symbol = f"law_{declaration.name}" if inline else declaration.name
        self.functions[declaration.name] = {"symbol": symbol, "inline": inline, "returns": returns,
                                            "parameters": parameters,
                                            "doc": self.about.get(declaration.name, ""),
                                            "signature": f"{returns} {declaration.name}({arguments})"}


def read_shapes(path=os.path.join(here, "shapes.txt")):
    """function.parameter -> shape; and roles. See the head of shapes.txt."""
    shapes = {}
    with open(path, encoding="utf-8") as file:
        for line in file:
            line = line.split("#")[0].strip()
            if line:
                key, _, value = (part.strip() for part in line.partition(":"))
                if key in shapes:
                    sys.exit(f"{path}: {key} stands there twice")
                shapes[key] = value
    return shapes


def parts_of(shape):
    """The axes of a shape as they stand there, without what comes before the brackets."""
    found = re.search(r"\[(.*)\]", shape)
    return [part.strip() for part in re.sub(r"\bdef\b", "definition", found[1]).split(",")] if found else []


def give_roles(headers, shapes):
    """Tells of each parameter what Python does with it: given, optional, made (an answer), length (told by an array) or
    hidden."""
    opaque = {name for h in headers for name, kind in h.types.items() if kind["opaque"]}
    for h in headers:
        for name, f in h.functions.items():
            for p in f["parameters"]:
                p["called"] = "definition" if p["name"] == "def" else p["name"] + "_" * keyword.iskeyword(p["name"])
                p["base"] = re.sub(r"\bconst\b|\bstruct\b|\*|\[.*", "", p["type"]).strip()
                p["shape"] = shapes.get(f"{name}.{p['name']}", "")
                inout, optional = p["shape"].startswith("inout"), p["shape"].startswith("optional")
                constant = p["const"] or "const" in p["type"]
                if (p["deep"] and p["base"] == "char" or p["pointer"] and p["base"] == "void"
                    or p["base"].endswith(("_memory", "_allocator"))):
                    p["role"] = "hidden"
                elif (p["pointer"] and not constant and not inout and not optional and not p["callback"]
                      and (p["base"] not in opaque or name.endswith("_init"))):
                    p["role"] = "made"
                else:
                    p["role"] = "optional" if optional else "given"
                p["function"] = p["callback"] or "_fn" in p["type"] or p["base"].endswith(("_function", "_kernel"))
            # what a definition holds and C calls with the definition's data
            f["hook"] = not any(p["function"] for p in f["parameters"]) and any(
                p["pointer"] and p["base"] == "void" and (p["name"] == "data" or "user" in p["name"])
                for p in f["parameters"])
            f["lengths"] = lengths_of(f["parameters"])
            for p in f["parameters"]:
                if p["called"] in f["lengths"]:
                    p["role"] = "length"


def lengths_of(parameters):
    """Integers that the length of an array tells: parameter -> array's parameter, axis, what to take off."""
    found = {}
    names = {p["called"] for p in parameters if not p["pointer"]}
    for optional in (False, True):
        for p in parameters:
            if p["role"] in ("made", "hidden") or (p["role"] == "optional") != optional:
                continue
            for axis, part in enumerate(parts_of(p["shape"])):
                parameter, _, more = part.partition("+")
                if parameter.strip() in names and more.strip() in ("", "1"):
                    found.setdefault(parameter.strip(), [p["called"], axis, int(more or 0)])
    return found


def without_shape(header, shapes):
    missing = []
    for name, function in header.functions.items():
        if shapes.get(name, "").startswith("C only"):
            continue
        for p in function["parameters"]:
            key = f"{name}.{p['name']}"
            if p["pointer"] and p["target"] and p["target"] in NUMBERS and key not in shapes:
                missing.append(key)
    for name, kind in header.types.items():
        for field, about in kind["fields"].items():
            if about.get("pointer") in NUMBERS and f"{name}.{field}" not in shapes:
                missing.append(f"{name}.{field}")
    return missing


NUMBERS = {"double", "_Bool", "unsigned char", "float", "int", "size_t", "int32_t", "int64_t", "uint64_t", "uint32_t",
           "uint8_t", "unsigned", "unsigned int", "ptrdiff_t"}


def laws_of(h):
    """A symbol for every law of a header, and the sizes of what only C looks into."""
    lines = []
    for name, f in h.functions.items():
        if f["inline"]:
            arguments = ", ".join(p["text"] for p in f["parameters"]) or "void"
            call = f"{name}({', '.join(p['name'] for p in f['parameters'])})"
            body = f"{call};" if f["returns"] == "void" else f"return {call};"
            lines.append(f"extern {f['returns']} law_{name}({arguments});\n{f['returns']} law_{name}({arguments}) "
                         f"{{ {body} }}")
    for name, kind in h.types.items():
        if kind["opaque"]:
            lines.append(f"extern size_t size_of_{name}(void);\nsize_t size_of_{name}(void) {{ return "
                         f"sizeof({name}); }}")
    return lines


def c_files(headers):
    """dem.h with the helpers takes as long to compile as all other headers: two files, for two cores."""
    dem = [h for h in headers if h.file == "dem.h"]
    rest = [h for h in headers if h.file != "dem.h"]
    layout = [name for h in headers for name, kind in h.types.items() if not kind["opaque"]]
    sizes = ["extern size_t riddle_layout(int);\nsize_t riddle_layout(int n) {\n    switch (n) {"]
    sizes += [f"    case {k}: return sizeof({name});" for k, name in enumerate(layout)]
    sizes.append("    default: return 0;\n    }\n}")
    first = "/* Of the shared library of the Python binding. Generated by generate.py. */"

    def bodies(some):
        return [line for h in some for line in
                (f"#define {h.upper}_API extern", f"#define {h.upper}_IMPLEMENTATION", f'#include "{h.file}"')]

    with_dem = [first, *bodies(dem), '#include "helpers.h"', *[line for h in dem for line in laws_of(h)]]
    with_rest = [first, "#define DEM_API extern", '#include "dem.h"', *bodies(rest),
                 *[line for h in rest for line in laws_of(h)], *sizes]
    return {"shared_dem.c": with_dem, "shared_rest.c": with_rest}, layout


def cdef(headers):
    lines = []
    for h in headers:
        lines += h.declarations
        for name, f in h.functions.items():
            arguments = ", ".join(p["text"] for p in f["parameters"]) or "void"
            lines.append(f"{f['returns']} {f['symbol']}({arguments});")
        lines += [f"size_t size_of_{name}(void);" for name, kind in h.types.items() if kind["opaque"]]
    lines.append("size_t riddle_layout(int n);")
    with open(os.path.join(here, "helpers.h"), encoding="utf-8") as file:
        lines += [f"{prototype};" for prototype in re.findall(r"^RIDDLE_EXPORT ([^{;]*\))", file.read(), re.M)]
    return "\n".join(lines)


def version():
    with open(os.path.join(root, "VERSION"), encoding="utf-8") as file:
        return file.read().strip()


def main():
    folder = sys.argv[1]
    os.makedirs(folder, exist_ok=True)
    headers = [Header(name) for name in HEADERS if os.path.exists(os.path.join(root, name))]
    shapes = read_shapes()
    missing = [key for h in headers for key in without_shape(h, shapes)]
    if missing:
        print("python/shapes.txt lacks:\n" + "\n".join(missing), file=sys.stderr)
        return 1
    give_roles(headers, shapes)
    sources, layout = c_files(headers)
    api = {"version": version(), "layout": layout,
           "headers": {h.lower: {"file": h.file, "constants": h.constants, "enums": h.enums,
                                 "enumerators": h.enumerators, "types": h.types, "functions": h.functions}
                       for h in headers}, "shapes": shapes}
    for name, lines in sources.items():
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")
    with open(os.path.join(folder, "api.json"), "w", encoding="utf-8") as file:
        json.dump(api, file, indent=1)
    import cffi
    ffi = cffi.FFI()
    ffi.cdef(cdef(headers))
    ffi.set_source("riddle._types", None)
    ffi.emit_python_code(os.path.join(folder, "_types.py"))
    stubs.write(folder, headers, shapes)
    return 0


if __name__ == "__main__":
    sys.exit(main())
