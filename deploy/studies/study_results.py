# SPDX-License-Identifier: MIT
"""Reads the results of a study of hapticast-client study, a dataset of BIDS (client/study/README.md)."""
import csv
import dataclasses
import json
import re

import numpy as np

NEEDED = ("trial_type", "condition", "comparison_interval", "level", "answer", "is_correct", "status")


class WrongInput(Exception):
    """One line for the user: the file, the problem, the remedy."""


@dataclasses.dataclass
class Answers:
    """Answers of one subject to one condition. `levels` and `correct` are empty for ratings."""

    subject: str
    condition: str
    values: list = dataclasses.field(default_factory=list)
    levels: list = dataclasses.field(default_factory=list)
    correct: list = dataclasses.field(default_factory=list)


@dataclasses.dataclass
class Results:
    """All answers to one task, and the words for its figure."""

    task: str
    conditions: list = dataclasses.field(default_factory=list)  # names, in the order of the study
    answers: list = dataclasses.field(default_factory=list)
    settings: dict = dataclasses.field(default_factory=dict)  # name -> (settings, file)
    unit: str = "1"
    base: float | None = None  # value of the reference interval
    question: dict = dataclasses.field(default_factory=dict)

    def of(self, condition):
        return [each for each in self.answers if each.condition == condition]

    @property
    def subjects(self):
        return sorted({each.subject for each in self.answers})

    @property
    def is_choice(self):
        return any(each.levels for each in self.answers)


def read_file(file, parse=str):
    try:
        return parse(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise WrongInput(f"{file}: is missing; copy the whole folder of the subject") from None
    except (OSError, ValueError) as error:
        raise WrongInput(f"{file}: cannot be read ({error}); copy it from the machine of the study again") from None


def read_number(text, least=-np.inf):
    number = float(text)
    if not (np.isfinite(number) and number > least):
        raise ValueError(text)
    return number


def read_rows(file):
    """Returns the rows of a table. An interrupted last line, without its end, is left out."""
    text = read_file(file)
    lines = text[: text.rfind("\n") + 1].splitlines()
    rows = list(csv.DictReader(lines, delimiter="\t", quoting=csv.QUOTE_NONE))
    header = lines[0].split("\t") if lines else []
    missing = [name for name in NEEDED if name not in header]
    if missing:
        raise WrongInput(f"{file}: has no column {missing[0]}; give the folder of --out of hapticast-client study")
    for number, row in enumerate(rows, 2):
        if None in row or None in row.values():
            raise WrongInput(f"{file}:{number}: has not {len(header)} fields; copy it from the machine again")
    return rows


def list_files(folder):
    """Returns the events files of a dataset: task -> files, in the order of the subjects."""
    if not folder.is_dir():
        raise WrongInput(f"{folder}: is no folder; give the folder of --out of hapticast-client study")
    tasks = {}
    for file in sorted(folder.glob("sub-*/motion/sub-*_task-*_events.tsv")):
        found = re.fullmatch(r"sub-[0-9A-Za-z]+_task-([0-9A-Za-z]+)_events\.tsv", file.name)
        if found:
            tasks.setdefault(found[1], []).append(file)
    if not tasks:
        raise WrongInput(f"{folder}: has no sub-*/motion/*_events.tsv; give the folder of --out")
    return tasks


def choose_task(folder, tasks, wanted):
    if wanted in tasks:
        return wanted
    names = ", ".join(sorted(tasks))
    if wanted:
        raise WrongInput(f"{folder}: has no task {wanted}; it has {names}")
    if len(tasks) > 1:
        raise WrongInput(f"{folder}: has several tasks; choose one with --task: {names}")
    return next(iter(tasks))


def read_names(file, results):
    """Returns the conditions of a subject: code -> name. Adds the facts of the task to `results`."""
    sidecar = file.with_suffix(".json")
    described = read_file(sidecar, json.loads)
    try:
        levels = described["condition"]["Levels"]
        level = described.get("level", {})
        results.unit = level.get("Units", "1")
        reference = level.get("Reference")
        split = {code: text.split(": ", 1) for code, text in levels.items()}
        names = {code: (name, settings.split(", ", 1)[-1]) for code, (name, settings) in split.items()}
    except (KeyError, TypeError, ValueError, AttributeError):
        raise WrongInput(f"{sidecar}: does not describe the conditions; copy it from the machine again") from None
    # The settings begin with the path of the recording, which may differ between machines.
    for name, settings in names.values():
        facts = (settings, reference)
        known, known_file = results.settings.setdefault(name, (facts, sidecar))
        if known != facts:
            raise WrongInput(f"{sidecar}: {name!r} is another condition than in {known_file}; use another --out")
    results.base = reference
    results.conditions += [name for name, _ in names.values() if name not in results.conditions]
    return {code: name for code, (name, _) in names.items()}


def read_subject(file, results):
    """Adds the answers of a subject to `results`."""
    subject = file.name.split("_")[0]
    names = read_names(file, results)
    answers = {code: Answers(subject, name) for code, name in names.items()}
    for number, row in enumerate(read_rows(file), 2):
        if row["trial_type"] != "main" or row["status"] != "valid":
            continue
        try:
            own = answers[row["condition"]]
            own.values.append(read_number(row["answer"]))
            if row["comparison_interval"] != "n/a":
                own.levels.append(read_number(row["level"], 0.0))
                own.correct.append(read_number(row["is_correct"]) == 1.0)
        except (KeyError, ValueError) as error:
            raise WrongInput(f"{file}:{number}: has a wrong field ({error}); copy it from the machine again") from None
    results.answers += [each for each in answers.values() if each.values]


def read_question(folder, task):
    """Returns the question of a task from a copy of its study file; {} without a copy."""
    for file in sorted(folder.glob(f"sourcedata/sub-*/sub-*_task-{task}_study.json")):
        return dict(read_file(file, json.loads).get("question", {}))
    return {}


def read_results(folder, wanted):
    tasks = list_files(folder)
    results = Results(choose_task(folder, tasks, wanted))
    for file in tasks[results.task]:
        read_subject(file, results)
    if not results.answers:
        raise WrongInput(f"{folder}: task {results.task} has no valid answer; run hapticast-client study first")
    results.conditions = [each for each in results.conditions if results.of(each)]
    results.question = read_question(folder, results.task)
    return results
