#!/usr/bin/env python3
"""Prints the coefficients of lib/include/fairlead/math/approx.hpp (needs python3-mpmath).

Each function is written as a fixed leading part plus a polynomial in x^2 (or x); the polynomial is the
Chebyshev interpolant of the remainder on the reduced range, which is within a few per cent of minimax.
"""
from mpmath import mp, mpf, sqrt, sin, cos, atan, exp, log, pi, chebyfit

mp.dps = 50


def sin_rest(z):  # (sin x - x) / x^3, z = x^2
    x = sqrt(z)
    return (sin(x) - x) / x**3 if z > mpf("1e-12") else mpf(-1) / 6 + z / 120


def cos_rest(z):  # (cos x - 1 + x^2/2) / x^4
    x = sqrt(z)
    return (cos(x) - 1 + z / 2) / z**2 if z > mpf("1e-12") else mpf(1) / 24 - z / 720


def atan_rest(z):  # (atan x - x) / x^3
    x = sqrt(z)
    return (atan(x) - x) / x**3 if z > mpf("1e-12") else mpf(-1) / 3 + z / 5


def exp_rest(x):  # (exp x - 1 - x) / x^2
    return (exp(x) - 1 - x) / x**2 if abs(x) > mpf("1e-12") else mpf(1) / 2 + x / 6


def log_rest(z):  # (log((1+s)/(1-s)) - 2 s) / s^3, z = s^2
    s = sqrt(z)
    return (log((1 + s) / (1 - s)) - 2 * s) / s**3 if z > mpf("1e-12") else mpf(2) / 3 + 2 * z / 5


RANGES = [  # name, remainder, low, high, terms for float, terms for double
    ("sin", sin_rest, 0, (pi / 4) ** 2, 3, 7),
    ("cos", cos_rest, 0, (pi / 4) ** 2, 3, 7),
    ("atan", atan_rest, 0, mpf(1) / 4, 6, 13),
    ("exp", exp_rest, -log(2) / 2, log(2) / 2, 5, 11),
    ("log", log_rest, 0, ((sqrt(2) - 1) / (sqrt(2) + 1)) ** 2, 3, 7),
]

for name, rest, low, high, float_terms, double_terms in RANGES:
    for kind, terms, digits in (("float", float_terms, 10), ("double", double_terms, 18)):
        poly, error = chebyfit(rest, [low, high], terms, error=True)
        values = ", ".join(mp.nstr(c, digits) for c in reversed(poly))
        print(f"{name}<{kind}>  error of the rest {mp.nstr(error, 3)}\n    {values}")


# lib/include/fairlead/curve/rotation.hpp: whole functions of the square, for the chart of rotations
CHART = [  # name, function of the square, end of the range, terms
    ("cos_of", lambda z: cos(sqrt(z)), mpf("1.25"), 5),
    ("sinc_of", lambda z: sin(sqrt(z)) / sqrt(z) if z > mpf("1e-12") else 1 - z / 6, mpf("1.25"), 5),
    ("atan_of", lambda z: atan(sqrt(z)) / sqrt(z) if z > mpf("1e-12") else 1 - z / 3, mpf(1), 8),
]
for name, function, high, terms in CHART:
    poly, error = chebyfit(function, [0, high], terms, error=True)
    print(f"{name}  error {mp.nstr(error, 3)}\n    {', '.join(mp.nstr(c, 9) for c in reversed(poly))}")
