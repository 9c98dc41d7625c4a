"""Campaigns on the command line: run one, watch one trial of it, show its results.

Campaigns themselves are in ``clients.campaigns``, options in ``sweep_options``.
"""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import replace
from pathlib import Path

from atlas_drake.clients.campaigns import Campaign, load_campaign, run_campaign
from atlas_drake.clients.campaigns.comparison import compare
from atlas_drake.clients.campaigns.plan import make_trial, number_of_trials, scenario_of
from atlas_drake.clients.campaigns.report import write_results
from atlas_drake.clients.campaigns.results import (
    TRIALS,
    read_campaign,
    read_records,
    same_result,
)
from atlas_drake.clients.campaigns.trial_runner import TrialRunner
from atlas_drake.clients.cli import exit_status
from atlas_drake.clients.cli.film import film_run, log_for_film
from atlas_drake.clients.cli.interrupts import nothing_cut_off
from atlas_drake.clients.cli.outputs import (
    check_outputs,
    invite_viewer,
    keep_log,
    open_view,
)
from atlas_drake.clients.cli.policy import policy_settings
from atlas_drake.clients.cli.progress import Progress, StatusLine, TrialProgress
from atlas_drake.clients.film import FILM_SIZE
from atlas_drake.clients.film.file import check_film
from atlas_drake.clients.logs.mcap_writer import check_log_path
from atlas_drake.clients.view.overlays import Overlays
from atlas_drake.clients.view.viewer import interactive, keep_serving
from atlas_drake.errors import ScenarioError

RESULTS = Path("results")
"""Folder of all campaigns whose folder is not named."""


def sweep(options: argparse.Namespace) -> int:
    """Runs a campaign, or one trial of it; returns the exit status.

    Raises:
        ScenarioError: If anything asked for cannot be done.
    """
    campaign = _campaign(options)
    out = options.out or RESULTS / campaign.name
    if options.only is not None:
        return _one_trial(campaign, out, options)
    for name in ("view", "log", "video"):
        if getattr(options, name):
            raise ScenarioError(f"--{name}", True, "is for one trial: name it, --only")
    progress = TrialProgress(sys.stdout)
    again = (
        "the same command goes on from there, and "
        f"`atlas-drake results {out}` shows what there is"
    )
    try:
        with progress:
            records = run_campaign(
                campaign,
                out,
                jobs=options.jobs if options.jobs is not None else os.cpu_count() or 1,
                cluster=options.cluster,
                on_trial=lambda record, done, total: progress.update(
                    record["success"], done, total
                ),
            )
        _show(out, progress)
    except KeyboardInterrupt:
        done = len(read_records(out))
        progress.say(f"Stopped with {done} trials done; {again}.")
        return exit_status.INTERRUPTED
    except OSError as error:
        progress.say(f"! {out} cannot be written: {error.strerror or error}; {again}.")
        return exit_status.FAILED
    raised = [number for number, record in sorted(records.items()) if record["error"]]
    if raised:
        progress.say(
            f"! {len(raised)} of {len(records)} trials ended with an error, the first "
            f"of them trial {raised[0]}, see {out / TRIALS}."
        )
    if campaign.goal is None:
        return exit_status.FAILED if raised else exit_status.OK
    share = sum(record["success"] for record in records.values()) / len(records)
    met = share >= campaign.goal
    progress.say(
        f"Goal: {100 * campaign.goal:g} % succeed, {'' if met else 'not '}met."
    )
    return exit_status.OK if met else exit_status.FAILED


def show_results(options: argparse.Namespace) -> int:
    """Writes and prints what the results amount to."""
    progress = StatusLine(sys.stdout)
    try:
        _show(options.folder, progress)
    except OSError as error:
        progress.say(f"! {options.folder} cannot be written: {error.strerror}")
        return exit_status.OUTPUT_LOST
    return exit_status.OK


def show_comparison(options: argparse.Namespace) -> int:
    """Prints what differs between two campaigns."""
    folders = (options.first, options.second)
    for folder in folders:
        read_campaign(folder)
    first, second = map(read_records, folders)
    text = compare(first, second, (str(options.first), str(options.second)))
    StatusLine(sys.stdout).say_lines(text)
    return exit_status.OK


def _campaign(options: argparse.Namespace) -> Campaign:
    """Returns the campaign as the command line changes it; ``--set`` comes last."""
    names = ("model", "world", "physics_step")
    overrides = {name: getattr(options, name) for name in names}
    campaign = load_campaign(
        options.campaign,
        [*policy_settings(options), *options.set],
        {name: value for name, value in overrides.items() if value is not None},
    )
    changed = {"seed": options.seed, "trials": options.trials}
    changed = {name: value for name, value in changed.items() if value is not None}
    code = list(campaign.code)
    if options.parts is not None:
        code.append(str(options.parts.absolute()))
    return replace(campaign, code=code, **changed).validate()


def _show(out: Path, progress: StatusLine) -> None:
    with nothing_cut_off():
        text, written = write_results(out)
    progress.say_lines(text)
    progress.say(f"Wrote {', '.join(str(path) for path in written)}.")


def _one_trial(campaign: Campaign, out: Path, options: argparse.Namespace) -> int:
    """Does one trial here, to be watched or kept."""
    trials = number_of_trials(campaign)
    if options.only < 0 or (trials is not None and options.only >= trials):
        problem = f"must be the number of a trial, from 0; there are {trials or 'more'}"
        raise ScenarioError.about("--only", options.only, problem)
    check_outputs(options, ("log", "video"))
    if options.video is not None:
        check_film(options.video, FILM_SIZE)
    if options.log is not None:
        check_log_path(options.log)
    options.headless, options.record = not options.view, None
    options.video_size = FILM_SIZE
    trial = make_trial(campaign, options.only)
    progress = Progress(sys.stdout, scenario_of(campaign, trial).duration)
    for path, value in {"seed": trial.seed, **trial.values}.items():
        progress.say(f"{path} = {value}")
    meshcat = open_view(options, progress)
    trial_runner = TrialRunner(campaign)
    with log_for_film(options) as log:
        sim = trial_runner.simulation(
            trial,
            view=meshcat,
            overlays=Overlays(options.show),
            log=log,
            listeners=[progress],
        )
        invite_viewer(meshcat, options, progress)
        if options.view:
            sim.set_realtime_rate(1.0)
        try:
            record = trial_runner.judged(sim, trial)
        finally:
            with nothing_cut_off():
                kept = keep_log(sim, options, progress)
        if options.video is not None and log is not None:
            world = trial_runner.parts.get("world", ())
            kept = film_run(log, options, progress, world) == exit_status.OK and kept
    for name, value in record["figures"].items():
        progress.say(f"{name:20} {value}")
    failed = ", ".join(f"not {text}" for text in record["missed"])
    progress.say("Success." if record["success"] else f"Failed: {failed}.")
    stored = read_records(out).get(trial.number)
    if stored is not None and stored["seed"] == trial.seed:
        same = same_result(stored) == same_result(record)
        progress.say(f"{'The same as' if same else '! Not the same as'} in {out}.")
    if not kept:
        return exit_status.OUTPUT_LOST
    if options.view and interactive():
        keep_serving(progress.say)
    return exit_status.OK if record["success"] else exit_status.FAILED
