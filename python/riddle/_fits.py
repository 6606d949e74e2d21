"""What the results of fits say when they are printed: each parameter with its range, and what the data leave open."""
import html
import math

from . import _core
from ._core import lib


def _row(name, value, low, high, note=""):
    return {"parameter": name, "value": float(value), "low": float(low), "high": float(high), "note": note}


def _screen(fit):
    header = _core.api["headers"]["screen"]["functions"]["screen_parameter_name"]["symbol"]
    for k in range(fit.parameters):
        name = _core.ffi.string(getattr(lib, header)(fit.model, k)).decode()
        note = ("stands at its bound" if fit.at_bound[k] else "without influence on these data"
                if math.isinf(fit.error[k]) else
                "held" if fit.error[k] == 0.0 else "" if fit.determined[k] else "the data leave it open")
        yield _row(name, fit.parameter[k], fit.low[k], fit.high[k], note)


def _blocking(fit):
    yield _row("k [1/s]", fit.k, fit.k_lowest, fit.k_highest, "" if fit.k_determined else "the readings leave it open")
    yield _row("f0", fit.f0, fit.f0_lowest, fit.f0_highest, "stands at its bound" if fit.f0_on_bound else "")
    yield _row("f_inf", fit.f_inf, fit.f_inf_lowest, fit.f_inf_highest,
               "stands at its bound" if fit.f_inf_on_bound else "" if fit.f_inf_determined
               else "the readings leave it open")


def _classifier(fit):
    border, curve = int(fit.at_border), fit.curve
    bits = _core._constants["classifier"]
    for name, sd, bit in (("size", fit.size_sd, None), ("slope", fit.slope_sd, "FREE_SLOPE"),
                          ("bypass", fit.bypass_sd, "FREE_BYPASS"), ("hook_size", fit.hook_sd, "FREE_HOOK")):
        value = getattr(curve, name, None)
        if value is not None:
            at = bit in bits and border & bits[bit]
            note = ("stands at its border" if at else "the points leave it open" if math.isinf(sd) else "held"
                    if sd == 0.0 else "")
            yield _row(name, value, value - fit.student * sd if sd else value, value + fit.student * sd if sd
                       else value, note)


_ROWS = {"screen_fit_result": _screen, "blocking_fit_result": _blocking, "classifier_fit_result": _classifier}


def rows(fit):
    """A row a parameter: parameter, value, low and high of the 95 % range, note. pandas.DataFrame(fit.rows()) shows
    them too."""
    return list(_ROWS[fit._name](fit))


def _range(row):
    return ("" if row["note"] in ("held", "without influence on these data")
            else f"{row['low']:.4g} .. {row['high']:.4g}")


def _text(fit):
    table = [(row["parameter"], f"{row['value']:.4g}", _range(row), row["note"]) for row in rows(fit)]
    widths = [max(len(line[k]) for line in [*table, ("parameter", "value", "95 % range", "")]) for k in range(3)]
    lines = [f"{'parameter':{widths[0]}}  {'value':>{widths[1]}}  {'95 % range':{widths[2]}}"]
    lines += [f"{name:{widths[0]}}  {value:>{widths[1]}}  {between:{widths[2]}}  {note}".rstrip()
              for name, value, between, note in table]
    return "\n".join(line.rstrip() for line in lines)


def _html(fit):
    cells = "".join("<tr>"
                    + "".join(f"<td style='text-align:left'>{html.escape(cell)}</td>"
                              for cell in (r["parameter"], f"{r['value']:.4g}", _range(r), r["note"])) + "</tr>"
                    for r in rows(fit))
    return f"<table><tr><th>parameter</th><th>value</th><th>95 % range</th><th></th></tr>{cells}</table>"


for _name in _ROWS:
    _class = _core._classes[_name]
    _class.rows, _class.__str__, _class._repr_html_ = rows, _text, _html
