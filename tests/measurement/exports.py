"""A swing as other programs export it, alone or in a zip archive."""

import io
import zipfile

import numpy as np

TIME = np.arange(600) / 60
SWING = 0.4 * np.exp(-0.03 * TIME) * np.cos(7 * TIME + 0.1)


def rows(*columns, separator=",", comma=False, digits=6):
    lines = [separator.join(f"{x:.{digits}f}" for x in row) + "\n" for row in zip(*columns, strict=True)]
    text = "".join(lines)
    return text.replace(".", ",") if comma else text


def video(angle=SWING, tilt=0.0):
    """x and y in m about a pivot at (0.31, 1.2) on an arm of 0.8 m."""
    return 0.31 + 0.8 * np.sin(angle + tilt), 1.2 - 0.8 * np.cos(angle + tilt)


# What each program writes: text, encoding, and the unit in which the swing stands in it.
EXPORTS = {
    # Tracker: a line with the track's name, then the header without units; tabs; the decimal sign of the country
    "tracker": ("mass A\t\t\nt\tx\ty\n" + rows(TIME, *video(), separator="\t", comma=True), "utf-8", "rad"),
    # phyphox, "CSV (semicolon, decimal comma)": quoted names with units
    "phyphox": (
        '"Time (s)";"Angle (°)"\n' + rows(TIME, np.degrees(SWING), separator=";", comma=True),
        "utf-8",
        "deg",
    ),
    # phyphox, the gyroscope's raw data: three axes and how fast it turns in all, of which one is the pendulum's
    "phyphox_gyroscope": (
        '"Time (s)";"Gyroscope x (rad/s)";"Gyroscope y (rad/s)";"Gyroscope z (rad/s)";"Absolute (rad/s)"\n'
        + rows(TIME, 0.01 * SWING, 0.02 * SWING, SWING, np.abs(SWING), separator=";", comma=True),
        "utf-8",
        "rad/s",
    ),
    # Logger Pro and Graphical Analysis: the data set's name before each column
    "logger_pro": (
        "Latest: Time (s),Latest: Angle (°)\r\n" + rows(TIME, np.degrees(SWING)).replace("\n", "\r\n"),
        "latin-1",
        "deg",
    ),
    "graphical_analysis": (
        "Data Set 1:Time(s)\tData Set 1:Angle(rad)\n" + rows(TIME, SWING, separator="\t"),
        "utf-8-sig",
        "rad",
    ),
    # PASCO Capstone: the run's number in each name
    "capstone": (
        "Time (s) Run #1,Angular Velocity (rad/s) Run #1,Angle (rad) Run #1\n"
        + rows(TIME, np.gradient(SWING, TIME), SWING),
        "utf-16",
        "rad",
    ),
    "arduino": ("millis,angle_deg\n" + rows(1000 * TIME, np.degrees(SWING)), "utf-8", "deg"),
    "arduino_without_header": (rows(TIME, SWING, separator="\t"), "utf-8", "rad"),
    "spaces": ("t/s theta/rad\n" + rows(TIME, SWING, separator="  "), "utf-8", "rad"),
    "savetxt": ("# t_s theta_rad\n" + rows(TIME, SWING, separator=" "), "utf-8", "rad"),
    "units_below": (
        "time;angle\nms;deg\n" + rows(1000 * TIME, np.degrees(SWING), separator=";"),
        "utf-8",
        "deg",
    ),
    "quoted": (
        '"Zeit (s)","Winkel [rad]"\n'
        + "".join(f'"{t:.6f}","{x:.6f}"\n'.replace(".", ",") for t, x in zip(TIME, SWING, strict=True)),
        "latin-1",
        "rad",
    ),
}


def zipped(members):
    """The bytes of a zip archive of these contents by name."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, content in members.items():
            packed.writestr(name, content)
    return stream.getvalue()
