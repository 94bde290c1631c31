#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""Analyses the results of a study of hapticast-client study.

  analyse.py DIR [--task NAME] [--figure FILE.png] [--table FILE.tsv]

DIR is the folder of --out. Only valid trials of the main part count. Forced choices (2afc) give thresholds (JND), from
the fit of a psychometric function. Ratings give n, mean, standard deviation and median. Needs python3-numpy and
python3-matplotlib.
"""
import argparse
import dataclasses
import pathlib
import re
import sys

import numpy as np

from study_results import WrongInput, read_results

GUESS = 0.5  # probability of a correct answer by chance
STEPS = 241  # of the threshold in the grid of the fit
SLOPES = np.geomspace(0.7, 7.0, 41)  # as client/study/threshold_posterior.hpp
TICKS = np.outer(10.0 ** np.arange(-6, 7), (1, 2, 5)).ravel()  # of a logarithmic axis
DROP_95 = 1.92  # log likelihood at the ends of a 95 % interval: half of the chi-square quantile


# Fit of the psychometric function


def compute_correct(level, threshold, slope, lapse):
    """The function of client/study/psychometric_function.hpp."""
    return GUESS + (1.0 - GUESS - lapse) * (1.0 - np.exp2(-((level / threshold) ** slope)))


@dataclasses.dataclass
class Fit:
    """Result of maximum likelihood. A limit is None if the answers do not bound the threshold there."""

    threshold: float
    slope: float
    low: float | None
    high: float | None
    is_measured: bool = True  # False: the best threshold is at an end of the grid


def compute_likelihoods(levels, correct, thresholds, lapse):
    """Returns the logarithm of the likelihood, slopes x thresholds."""
    unique, index = np.unique(levels, return_inverse=True)
    right = np.bincount(index, weights=correct)
    wrong = np.bincount(index) - right
    rows = []
    for slope in SLOPES:
        p = compute_correct(unique, thresholds[:, None], slope, lapse)
        p = np.clip(p, 1e-9, 1.0 - 1e-9)
        rows.append(np.log(p) @ right + np.log1p(-p) @ wrong)
    return np.array(rows)


def find_crossing(axis, profile, least, order):
    """Returns where the profile falls below `least` first, in this order of indices; None if it never does."""
    for before, after in zip(order[:-1], order[1:]):
        if profile[after] < least:
            share = (profile[before] - least) / (profile[before] - profile[after])
            return float(np.exp(axis[before] + share * (axis[after] - axis[before])))
    return None


def fit_threshold(levels, correct, lapse):
    """Fits threshold and slope by a grid, with the interval of the profile likelihood."""
    levels = np.asarray(levels, float)
    # A threshold beyond the levels by more than a factor of 3 is not measured.
    axis = np.linspace(np.log(levels.min() / 3.0), np.log(levels.max() * 3.0), STEPS)
    likelihoods = compute_likelihoods(levels, np.asarray(correct, float), np.exp(axis), lapse)
    profile = likelihoods.max(axis=0)
    best = int(profile.argmax())
    slope = float(SLOPES[likelihoods[:, best].argmax()])
    least = profile[best] - DROP_95
    low = find_crossing(axis, profile, least, range(best, -1, -1))
    high = find_crossing(axis, profile, least, range(best, STEPS))
    return Fit(float(np.exp(axis[best])), slope, low, high, 0 < best < STEPS - 1)


# Tables: lists of rows, the first one is the header


def format_number(value):
    return "n/a" if value is None else f"{value:.4g}"


def pool(answers, name):
    return [value for each in answers for value in getattr(each, name)]


def make_choice_table(results, lapse):
    """Returns the table, and the pooled fits: condition -> Fit."""
    table = [["condition", "subject", "n", "correct", "reference", "threshold", "low_95", "high_95", "slope", "unit"]]
    fits = {}

    def add(condition, subject, answers):
        levels, correct = pool(answers, "levels"), pool(answers, "correct")
        fit = fit_threshold(levels, correct, lapse)
        found = (fit.threshold, fit.low, fit.high, fit.slope) if fit.is_measured else (None,) * 4
        numbers = [np.mean(correct), results.base, *found]
        table.append([condition, subject, str(len(levels)), *map(format_number, numbers), results.unit])
        return fit

    for condition in results.conditions:
        own = results.of(condition)
        for each in own:
            add(condition, each.subject, [each])
        fits[condition] = add(condition, "pooled", own)
    return table, fits


def make_rating_table(results):
    table = [["condition", "subjects", "n", "mean", "sd", "median"]]
    for condition in results.conditions:
        own = results.of(condition)
        values = np.array(pool(own, "values"))
        deviation = float(values.std(ddof=1)) if values.size > 1 else None
        numbers = [values.mean(), deviation, np.median(values)]
        table.append([condition, str(len(own)), str(values.size), *map(format_number, numbers)])
    return table


def print_table(table):
    """Prints aligned columns: text to the left, numbers to the right."""
    widths = [max(len(row[i]) for row in table) for i in range(len(table[0]))]
    numeric = [any(re.fullmatch(r"[-+.0-9e]+", row[i]) for row in table[1:]) for i in range(len(widths))]
    for row in table:
        cells = [f"{cell:>{w}}" if right else f"{cell:<{w}}" for cell, w, right in zip(row, widths, numeric)]
        print("  ".join(cells).rstrip())


def write_table(file, table):
    try:
        file.write_text("".join("\t".join(row) + "\n" for row in table), encoding="utf-8")
    except OSError as error:
        raise WrongInput(f"{file}: cannot be written ({error.strerror}); give another --table") from None


# Figures


def open_figure(width, height):
    try:
        import matplotlib  # pylint: disable=import-outside-toplevel
    except ImportError:
        raise WrongInput("--figure: matplotlib is missing; apt-get install python3-matplotlib") from None
    matplotlib.use("Agg")
    from matplotlib import pyplot  # pylint: disable=import-outside-toplevel

    return pyplot.subplots(figsize=(width, height), layout="constrained")


def save_figure(figure, file):
    try:
        figure.savefig(file, dpi=150)
    except (OSError, ValueError) as error:
        raise WrongInput(f"{file}: cannot be written ({error}); give another --figure, such as out.png") from None


def bin_answers(levels, correct, most=12):
    """Returns level, share of correct answers and number of trials, of each level or of bins of a logarithmic scale."""
    levels, correct = np.asarray(levels, float), np.asarray(correct, float)
    bins, index = np.unique(levels, return_inverse=True)
    if bins.size > most:
        edges = np.geomspace(levels.min(), levels.max(), most + 1)[1:-1]
        index = np.unique(np.searchsorted(edges, levels), return_inverse=True)[1]
    count = np.bincount(index)
    mean = np.exp(np.bincount(index, weights=np.log(levels)) / count)
    return mean, np.bincount(index, weights=correct) / count, count


def draw_choice(axes, results, fits, lapse):
    """Draws points, curves and thresholds with their intervals, a colour for each condition."""
    levels = np.array(pool(results.answers, "levels"))
    x = np.geomspace(levels.min() / 1.3, levels.max() * 1.3, 300)
    bins = [bin_answers(pool(own, "levels"), pool(own, "correct")) for own in map(results.of, fits)]
    bottom = min(0.47, *(share.min() for _, share, _ in bins)) - 0.05
    for i, (condition, fit) in enumerate(fits.items()):
        color = f"C{i % 10}"
        jnd, low, high = map(format_number, (fit.threshold, fit.low, fit.high))
        level, share, count = bins[i]
        axes.scatter(level, share, s=300.0 * count / count.max(), color=color, alpha=0.5, linewidths=0)
        if not fit.is_measured:
            axes.plot([], [], color=color, label=f"{condition}: not measured")
            continue
        label = f"{condition}: JND {jnd} ({low} to {high})"
        axes.plot(x, compute_correct(x, fit.threshold, fit.slope, lapse), color=color, label=label)
        height = compute_correct(fit.threshold, fit.threshold, fit.slope, lapse)
        foot = bottom - 0.04 * i
        axes.plot([fit.threshold] * 2, [foot, height], ":", color=color, linewidth=1)
        ends = [x[0] if fit.low is None else fit.low, x[-1] if fit.high is None else fit.high]
        axes.plot(ends, [foot] * 2, "-|", color=color)
        axes.plot(fit.threshold, foot, "o", color=color)
    finish_axes(axes, results, x)
    axes.set_ylim(bottom - 0.04 * len(fits), 1.03)


def finish_axes(axes, results, x):
    """Labels the axes of a psychometric function."""
    axes.set(xscale="log", xlim=(x[0], x[-1]))
    axes.set_yticks(np.arange(0.5, 1.01, 0.1))
    axes.set_xticks([each for each in TICKS if x[0] <= each <= x[-1]])
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter("")
    unit = "" if results.unit == "1" else f" [{results.unit}]"
    reference = "" if results.base is None else f" from the reference {results.base:g}"
    axes.set(xlabel=f"difference{reference}{unit}", ylabel="share of correct answers")
    axes.grid(alpha=0.3)


def draw_ratings(axes, results):
    """Draws a circle for each different answer (area: how often), and mean with standard deviation."""
    for i, condition in enumerate(results.conditions):
        values = np.array(pool(results.of(condition), "values"))
        unique, count = np.unique(values, return_counts=True)
        sizes = 600.0 * count / values.size
        axes.scatter(unique, np.full(unique.size, i), s=sizes, color="C0", alpha=0.35, linewidths=0)
        deviation = values.std(ddof=1) if values.size > 1 else 0.0
        label = "mean, standard deviation" if i == 0 else None
        axes.errorbar(values.mean(), i + 0.28, xerr=deviation, fmt="D", color="C1", capsize=4, label=label)
    axes.set_yticks(range(len(results.conditions)), results.conditions)
    axes.set_ylim(len(results.conditions) - 0.4, -0.6)
    question = results.question
    if question.get("kind") == "vas":
        low, high = 0, 100
    else:
        low, high = 1, question.get("steps", 7 if question else max(pool(results.answers, "values")))
        axes.set_xticks(np.arange(low, high + 1))
    margin = 0.07 * (high - low)
    axes.set_xlim(low - margin, high + margin)
    ends = [f"{low}: {question['low']}"] if question.get("low") else []
    ends += [f"{high}: {question['high']}"] if question.get("high") else []
    axes.set_xlabel("\n".join([question.get("text", "answer"), ";  ".join(ends)]).strip())
    axes.grid(axis="x", alpha=0.3)


def draw(results, fits, lapse, file):
    height = 5.0 if results.is_choice else 1.8 + 0.6 * len(results.conditions)
    figure, axes = open_figure(8.0, height)
    if results.is_choice:
        draw_choice(axes, results, fits, lapse)
    else:
        draw_ratings(axes, results)
    title = f"{results.task}, subjects: {len(results.subjects)}"
    axes.legend(title=title, alignment="left", loc="lower left", bbox_to_anchor=(0.0, 1.0), fontsize=8, frameon=False)
    save_figure(figure, file)


def read_options():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("folder", metavar="DIR", type=pathlib.Path, help="the folder of --out")
    options.add_argument("--task", metavar="NAME", help="the name of the study, if DIR has several")
    options.add_argument("--figure", metavar="FILE.png", type=pathlib.Path, help="write a figure")
    options.add_argument("--table", metavar="FILE.tsv", type=pathlib.Path, help="write the table")
    text = "share of wrong answers at any level, 0 to 0.2; default: 0.02"
    options.add_argument("--lapse", metavar="SHARE", type=float, default=0.02, help=text)
    chosen = options.parse_args()
    if not 0.0 <= chosen.lapse <= 0.2:
        options.error(f"--lapse {chosen.lapse:g} is no number from 0 to 0.2")
    return chosen


def main():
    options = read_options()
    try:
        results = read_results(options.folder, options.task)
        if results.is_choice:
            table, fits = make_choice_table(results, options.lapse)
        else:
            table, fits = make_rating_table(results), {}
        print_table(table)
        if options.table:
            write_table(options.table, table)
        if options.figure:
            draw(results, fits, options.lapse, options.figure)
    except WrongInput as error:
        print(f"analyse.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
