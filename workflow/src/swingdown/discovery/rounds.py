"""The rounds of a search: at each structure on its way, where the model fails, what was tried there, and what was chosen."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from ..fitting.least_squares import fit_jointly
from ..fitting.result import Fit
from ..own_unit import OF_AN_ANGLE
from ..pendulum.effect import NATURAL_FREQUENCY
from ..pendulum.model import Model
from ..pendulum.slack import Slack
from .criterion import USUAL, Criterion
from .data.campaign import Campaign
from .data.noise import Noise, coarse_noise, measure_noise, not_too_fine
from .judge.confirm import predict
from .judge.structures import Pool, Structure
from .move.evidence import Candidate, evidence
from .move.refit import nudged
from .see.curves import COLUMNS, forms, missing
from .see.locate import groups
from .see.losses import COLUMNS as HALF_SWINGS
from .see.losses import beside
from .see.torques import PLANE, torques
from .state import Round

_TIED = np.log(100.0)  # of the evidence, below which the data do not tell two moves apart


def first_fit(campaign: Campaign, base: Model) -> Fit:
    """The base model fitted jointly within the catalogue's bounds, the sensor and the clock taken for what they say."""
    if campaign.own:
        base = replace(base, catalogue=base.catalogue.without(*OF_AN_ANGLE))
    base = base.of(campaign.reading).with_slack(Slack(clock=campaign.slack.clock))
    fit = fit_jointly(base, [swing.pair for swing in campaign.fit], bounded=True)
    return nudged(fit, campaign.fit)


def noise_of(campaign: Campaign, fit: Fit) -> Noise:
    """The noise on a campaign's swings, from the residuals of a fit to them: of what it may be that which makes these residuals most
    probable, whether or not something is missing."""
    likely = _likely(campaign, fit, fit)
    return likely[0] if len(likely) == 1 else _most_probable(campaign, fit, fit, likely).noise


def pool_of(
    campaign: Campaign,
    fit: Fit,
    base: Fit | None = None,
    heard: Sequence[Noise] = (),
    criterion: Criterion = USUAL,
) -> Pool:
    """The structures of a fit and of its ``base`` (default: itself), seen near the fit: under its noise (``noise_of``), or one that was
    ``heard`` before, whichever makes one of them more probable. The pendulum's frequency is that of the base."""
    base = base or fit
    return _most_probable(campaign, fit, base, [*_likely(campaign, fit, base), *heard], criterion)


def _likely(campaign: Campaign, fit: Fit, base: Fit) -> list[Noise]:
    """The noises that are not improbable, the most likely first."""
    swings, frequency = campaign.fit, base.model.values[NATURAL_FREQUENCY.name] / (2 * np.pi)
    residuals = [
        (swing.times, swing.angle - one.angle) for swing, one in zip(swings, fit.swings, strict=True)
    ]
    measured = measure_noise(residuals, frequency, campaign.static, len(fit.free))
    least = measured[0].likely + np.log(USUAL.possible)
    likely = [noise for noise in measured if noise.likely > least]
    return [not_too_fine(coarse_noise(noise, swings, frequency), swings) for noise in likely]


def _most_probable(
    campaign: Campaign, fit: Fit, base: Fit, noises: Sequence[Noise], criterion: Criterion = USUAL
) -> Pool:
    pool = Pool(campaign, noises[0], base, fit, criterion=criterion)
    pool.look(fit)
    return max((pool, *map(pool.under, noises[1:])), key=lambda one: one.absolute)


def unseen(campaign: Campaign, fit: Fit) -> Round:
    """The only ``Round`` of a search that broke off."""
    curves, plane, table = (
        pd.DataFrame(columns=names) for names in (COLUMNS, PLANE, [*HALF_SWINGS, "swing", "of"])
    )
    noise = noise_of(campaign, fit)
    return Round(0, fit, predict(fit, campaign.holdout), noise, (), curves, plane, table, missing=True)


def round_of(
    number: int, pool: Pool, here: Structure, ranked: Sequence[Candidate], to: Structure | None
) -> Round:
    """The ``Round`` at a structure, what was ``ranked`` there, and the structure that the search went on ``to``."""
    campaign, noise, fit = pool.campaign, pool.noise, here.fit
    curves = forms(here.frame)
    names, pairs = [swing.name for swing in campaign.fit], [swing.pair for swing in campaign.fit]
    modelled = [(swing.times, one.angle) for swing, one in zip(campaign.fit, fit.swings, strict=True)]
    table = beside(
        names,
        pairs,
        modelled,
        fit.model.values[NATURAL_FREQUENCY.name],
        fit.model.restoring,
        campaign.reading,
    )
    return Round(
        number, fit, pool.held_out(fit), noise, tuple(groups(here.frame, noise, curves)),
        missing(here.frame, noise, curves), torques(pool.unnamed, here.frame), table, tuple(pool.added(here.key)), pool.lacks(here), here.left(noise), here.lacks.sizes, here.widened,
        tuple(ranked), _tied(pool, ranked), None if to is None else _move(here.fit, to.fit, noise),
        criterion=pool.criterion,
    )  # fmt: skip


def _tied(pool: Pool, ranked: Sequence[Candidate]) -> tuple[Candidate, ...]:
    """Those of the candidates that are about as probable as the most probable one."""
    known = [(one, pool.evidence_of(one.fit)) for one in ranked if not one.refused]
    most = max((value for _, value in known), default=-np.inf)
    return tuple(one for one, value in known if value > most - _TIED)


def _move(here: Fit, to: Fit, noise: Noise) -> Candidate:
    """The step from one fit to another as a candidate; its added and dropped effects in the models' order."""
    added = [name for name in to.model.names if name not in here.model.names]
    dropped = [name for name in here.model.names if name not in to.model.names]
    return Candidate(
        added[0] if added else None,
        " and ".join(dropped) or None,
        to,
        evidence(to, noise),
        also=tuple(added[1:]),
    )
