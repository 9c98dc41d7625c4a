"""Campaigns on the command line: run one, watch one trial of it, show its results.

Campaigns themselves are in ``atlas_drake.campaigns``, options in ``sweep_options``.
"""

from __future__ import annotations

import argparse
import os
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from atlas_drake.app import exit_status
from atlas_drake.app.film import film_run, log_for_film
from atlas_drake.app.interrupts import nothing_cut_off
from atlas_drake.app.outputs import (
    check_outputs,
    invite_viewer,
    keep_log,
    open_view,
)
from atlas_drake.app.progress import Progress, StatusLine, TrialProgress
from atlas_drake.campaigns import Campaign, CampaignError, Shard, load_campaign
from atlas_drake.campaigns.comparison import compare
from atlas_drake.campaigns.errors import check_packages
from atlas_drake.campaigns.folder import CampaignFolder, as_kept, merge, same_result
from atlas_drake.campaigns.plan import make_trial, number_of_trials, scenario_of
from atlas_drake.campaigns.results import write_results
from atlas_drake.campaigns.runner import run_campaign
from atlas_drake.campaigns.sources import Sources, joined
from atlas_drake.campaigns.threshold import level_of
from atlas_drake.campaigns.trial_runner import TrialRunner
from atlas_drake.errors import shown
from atlas_drake.logs.mcap_writer import check_log_path
from atlas_drake.visualization import FILM_SIZE
from atlas_drake.visualization.film_file import check_film
from atlas_drake.visualization.overlays import Overlays
from atlas_drake.visualization.viewer import interactive, keep_serving

RESULTS = Path("results")
"""Folder of all campaigns whose folder is not named."""


def sweep(options: argparse.Namespace) -> int:
    """Runs a campaign, or one trial of it; returns the exit status.

    Raises:
        ScenarioError: If anything asked for cannot be done.
    """
    campaign = _campaign(options)
    files = [] if options.parts is None else [options.parts]
    out = options.out or RESULTS / campaign.name
    if options.only is not None:
        sources = Sources(joined(campaign.code, files))
        return _one_trial(campaign, sources, CampaignFolder(out), options)
    for name in ("view", "log", "video"):
        if getattr(options, name):
            raise CampaignError(
                f"--{name}", True, "is for one trial: name it by --only"
            )
    check_packages()
    progress = TrialProgress(sys.stdout)
    try:
        with progress:
            records = run_campaign(
                campaign,
                out,
                trials=options.trials,
                jobs=_jobs(options),
                ray=options.ray,
                shard=_shard(options.shard),
                files=files,
                on_trial=lambda record, done, total: progress.update(
                    record["success"], done, total
                ),
            )
    except KeyboardInterrupt:
        done = len(CampaignFolder(out).records())
        progress.say(
            f"Stopped with {done} trials done; the same command goes on from there, "
            f"and `atlas-drake results {out}` shows what there is."
        )
        return exit_status.INTERRUPTED
    kept = _show(CampaignFolder(out), progress)
    raised = [number for number, record in sorted(records.items()) if record["error"]]
    if raised:
        progress.say(
            f"! {len(raised)} of {len(records)} trials ended with an error; that of "
            f"trial {raised[0]} is in {CampaignFolder(out).file_of(raised[0])}."
        )
    if kept != exit_status.OK:
        return kept
    if campaign.goal is None or not records:
        return exit_status.FAILED if raised else exit_status.OK
    share = sum(record["success"] for record in records.values()) / len(records)
    met = share >= campaign.goal
    progress.say(
        f"Goal: {100 * campaign.goal:g} % succeed, {'' if met else 'not '}met."
    )
    return exit_status.OK if met else exit_status.FAILED


def show_results(options: argparse.Namespace) -> int:
    """Merges shards if there are any, and writes what the results amount to."""
    progress = StatusLine(sys.stdout)
    folder = CampaignFolder(options.folder)
    if options.shards:
        count = merge(folder, [CampaignFolder(path) for path in options.shards])
        progress.say(f"Merged {count} trials into {folder.path}.")
    return _show(folder, progress)


def show_comparison(options: argparse.Namespace) -> int:
    """Prints what differs between two campaigns."""
    folders = [CampaignFolder(path) for path in (options.first, options.second)]
    for folder in folders:
        folder.campaign()
    names = (str(options.first), str(options.second))
    first, second = (folder.records() for folder in folders)
    StatusLine(sys.stdout).say(compare(first, second, names))
    return exit_status.OK


def _campaign(options: argparse.Namespace) -> Campaign:
    """The campaign with what the command line says of it; ``--set`` comes last."""
    names = ("model", "world", "physics_step")
    given = {name: getattr(options, name) for name in names}
    overrides = {name: value for name, value in given.items() if value is not None}
    campaign = load_campaign(options.campaign, options.set, overrides)
    if options.seed is not None:
        campaign = replace(campaign, seed=options.seed).validate()
    return campaign


def _jobs(options: argparse.Namespace) -> int:
    if options.jobs is not None:
        return int(options.jobs)
    return 0 if options.ray is not None else (os.cpu_count() or 1)


def _shard(text: str | None) -> Shard | None:
    if text is None:
        return None
    index, _, count = text.partition("/")
    if not (index.isdecimal() and count.isdecimal()):
        raise CampaignError(
            "--shard",
            text,
            f"is {shown(text)}; must be such as 2/5, the second of five",
        )
    return Shard(int(index), int(count))


def _show(folder: CampaignFolder, progress: StatusLine) -> int:
    """Writes and prints the results."""
    with nothing_cut_off():
        try:
            text, written = write_results(folder)
        except OSError as error:
            progress.say(f"! {folder.path} cannot be written: {error.strerror}")
            return exit_status.OUTPUT_LOST
    progress.say(text)
    progress.say(f"Wrote {', '.join(str(path) for path in written)}.")
    return exit_status.OK


# ---- one trial ---------------------------------------------------------------


def _one_trial(
    campaign: Campaign,
    sources: Sources,
    folder: CampaignFolder,
    options: argparse.Namespace,
) -> int:
    """Does one trial here, to be watched or kept."""
    if options.only < 0:
        raise CampaignError("--only", options.only, "must be 0 or more")
    trials = number_of_trials(campaign, options.trials)
    if trials is not None and options.only >= trials:
        raise CampaignError(
            "--only",
            options.only,
            f"is {options.only}; the campaign has {trials} trials, 0 to {trials - 1}",
        )
    check_outputs(options, ("log", "video"))
    if options.video is not None:
        check_film(options.video, FILM_SIZE)
    if options.log is not None:
        check_log_path(options.log)
    options.headless, options.record, options.video_size = (
        not options.view,
        None,
        FILM_SIZE,
    )
    trial = make_trial(campaign, options.only, level_of(campaign, options.only))
    progress = Progress(sys.stdout, scenario_of(campaign, trial).duration)
    for path, value in {"seed": trial.seed, **trial.values}.items():
        progress.say(f"{path} = {value}")
    meshcat = open_view(options, progress)
    trial_runner = TrialRunner(campaign, sources)
    with log_for_film(options) as log:
        sim = trial_runner.simulation(
            trial,
            view=meshcat,
            overlays=Overlays(options.show),
            log=log,
            on_event=progress.event,
        )
        invite_viewer(meshcat, options, progress)
        if options.view:
            sim.set_realtime_rate(1.0)
        try:
            judged = trial_runner.judged(sim, trial)
        finally:
            with nothing_cut_off():
                kept = keep_log(sim, options, progress)
        if options.video is not None and log is not None:
            world = sources.all_parts().get("world", ())
            kept = film_run(log, options, progress, world) == exit_status.OK and kept
    drawn = {"trial": trial.number, "seed": trial.seed, "values": trial.values}
    record = as_kept(drawn | judged)
    for name, value in record["figures"].items():
        progress.say(f"{name:20} {value}")
    progress.say("Success." if record["success"] else f"Failed: {_why(record)}.")
    _compare_with_folder(folder, record, progress)
    if not kept:
        return exit_status.OUTPUT_LOST
    if options.view and interactive():
        keep_serving(progress.say)
    return exit_status.OK if judged["success"] else exit_status.FAILED


def _why(judged: dict[str, Any]) -> str:
    return ", ".join(f"not {text}" for text in judged["missed"])


def _compare_with_folder(
    folder: CampaignFolder, record: dict[str, Any], progress: StatusLine
) -> None:
    """Says whether the campaign found the same, if it is the same and got that far."""
    stored = folder.records().get(record["trial"])
    if stored is None or stored["seed"] != record["seed"]:
        return
    same = same_result(stored) == same_result(record)
    progress.say(f"{'The same as' if same else '! Not the same as'} in {folder.path}.")
