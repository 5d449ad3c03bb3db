"""The demo's page: before and after, what was found, the seconds spent and the errors left."""

from __future__ import annotations

from html import escape
from pathlib import Path
from string import Template

import numpy as np

from ..ibl_toolkit import overlay
from ..ibl_toolkit.false_colour import depth_colours, ticks
from .demo_pictures import FARTHEST, NEAREST

TEMPLATE = Path(__file__).with_name("demo_page.html")


def page(report: dict) -> str:
    """The page (HTML) of a report, with its pictures as files beside it."""
    depth, seconds = report["depth"], report["seconds"]
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        blender=escape(report["blender"]),
        total=f"{seconds['total']:.0f}",
        frame=_picture(report, "frame"),
        panorama=_picture(report, "panorama"),
        roles=_roles(),
        colours=_colours(),
        ticks=_ticks(),
        lamps=str(report["lights"]["count"]),
        lamp_share=_percent(report["lights"]["share"], 0),
        nearest=f"{depth['nearest']:.2f}",
        farthest=f"{depth['farthest']:.2f}",
        coverage=_percent(depth["coverage"], 1),
        seconds=_rows((name, f"{spent:.1f}") for name, spent in seconds.items()),
        calibration=_rows(_calibration(report["calibration"])),
        light=_rows(_light(report)),
        shapes="".join(_shape(shape) for shape in report["shapes"]),
        warnings=_warnings(report),
    )


def _picture(report, name):
    picture, method = report["pictures"][name], report["pictures"]["method"]
    width, height = picture["size"]
    denoised = ", denoised" if report["pictures"]["denoised"] else ""
    return f"{width} × {height} px, {picture['samples']} samples{denoised}, method “{method}”"


def _calibration(found):
    spread = found["uncertainty"]
    return [
        ("Camera height, given", f"{found['camera_height']:.2f} m"),
        ("Tilt of the capture", f"{found['tilt_deg']:.2f}°"),
        ("Residual of the picks, rms", f"{found['residual_deg']:.3f}°"),
        ("σ of the tilt for ½ px of click error", f"{spread['tilt_deg']:.2f}°"),
        ("σ of the scale for ½ px of click error", f"{spread['scale_percent']:.2f} %"),
        ("Condition (1 is best)", f"{found['condition']:.1f}"),
    ]


def _light(report):
    untouched, dots = report["errors"]["untouched"], report["errors"]["white_dots"]
    share = _percent(untouched["share_of_pixels"], 0)
    ratio = "identical" if untouched["psnr_db"] is None else f"{untouched['psnr_db']:.1f} dB"
    return [
        ("Lights taken out of the panorama", f"{report['lights']['count']}"),
        ("Their share of its power", _percent(report["lights"]["share"], 0)),
        (f"Panorama against photograph, in the {share} where nothing interferes", ratio),
        ("White dots that the photograph does not have", f"{dots['frame'] + dots['panorama']}"),
    ]


def _shape(shape):
    size = " × ".join(f"{length:.2f}" for length in shape["size"] if length > 0)
    numbers = (size, str(shape["faces"]), f"{shape['residual'] * 1000:.1f}")
    words = (escape(shape["name"]), shape["kind"], shape["role"].lower())
    cells = [f"<td>{word}</td>" for word in words] + [f'<td class="n">{number}</td>' for number in numbers]
    return f"<tr>{''.join(cells)}</tr>"


def _warnings(report):
    shapes = [f"{shape['name']}: {text}" for shape in report["shapes"] for text in shape["warnings"]]
    return "".join(
        f"<p>Warning: {escape(text)}</p>" for text in (*report["calibration"]["warnings"], *shapes)
    )


def _rows(pairs):
    return "".join(f'<tr><td>{escape(name)}</td><td class="n">{value}</td></tr>' for name, value in pairs)


def _roles():
    lines = {
        "support: receives shadows": overlay.ROLE_COLOURS["SUPPORT"],
        "environment: shows and lights": overlay.ROLE_COLOURS["ENVIRONMENT"],
        "horizon": overlay.HORIZON_COLOUR,
        "xz plane": overlay.XZ_COLOUR,
        "yz plane": overlay.YZ_COLOUR,
    }
    return "".join(f'<span><i style="background: {_css(c)}"></i>{name}</span>' for name, c in lines.items())


def _colours():
    return ", ".join(
        _css(c) for c in depth_colours(np.geomspace(NEAREST, FARTHEST, 16)[None], NEAREST, FARTHEST)[0]
    )


def _ticks():
    def position(depth):
        return 100 * np.log(depth / NEAREST) / np.log(FARTHEST / NEAREST)

    return "".join(f'<span style="left: {position(t):.2f}%">{t:g} m</span>' for t in ticks(NEAREST, FARTHEST))


def _css(colour):
    return "#{:02x}{:02x}{:02x}".format(*(int(c) for c in colour))


def _percent(share, digits):
    return f"{100 * share:.{digits}f} %"
