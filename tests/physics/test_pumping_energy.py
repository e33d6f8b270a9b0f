"""Energy of a tether over a whole pumping cycle: what the kite gives is at the drum, in air and dampers, or stored."""

import pytest

from example_fmus.example_slaves import Model, example_fmus
from tetherfmu import EnergyAudit, TetherDynamicFree
from tetherfmu.libraries.examples import example
from tetherfmu.python.energy import POWERS

STEP = 0.01
CONTROL = ("steering", "depower")
FELT = ("heading", "apparent_wind_speed")


def flying():
    """Tether and models of the pumping cycle, with a short cycle; the models are started as the masters do it."""
    start = {**example("power_system.kite_power_system").START, "longest_length": 225.0}
    models = {}
    for name in ("PointMassKite", "FlightController", "Winch"):
        known = {variable.name for variable in example_fmus.slave(name)(instance_name=name, resources="").table}
        models[name] = Model(name, **{key: value for key, value in start.items() if key in known - {"heading"}})
    air = {key: start[key] for key in ("wind_profile", "wind_reference_height", "wind_exponent")}
    made = {key: start[key] for key in ("kite_mass", "segments", "initial_length", "initial_shape")}
    tether = TetherDynamicFree(**air, **made)
    wind = (start["wind_velocity[1]"], 0.0, 0.0)
    kite = [[start.get(f"initial_kite_{what}[{i}]", 0.0) for i in (1, 2, 3)] for what in ("position", "velocity")]
    return tether, models, tether.initialize(*kite, wind_velocity=wind), wind


def exchanged(models, outputs):
    """Inputs of all models from the outputs of the last step; returns those of the tether."""
    kite, controller, winch = models.values()
    given = {"kite_load": kite.get("kite_load"), "reel_out_speed": winch.get("reel_out_speed")}
    at_the_ground = {name: getattr(outputs, name) for name in ("ground_tension", "tether_length")}
    kite.set(kite_position=outputs.kite_position, kite_velocity=outputs.kite_velocity)
    kite.set(**{name: controller.get(name) for name in CONTROL})
    controller.set(kite_position=outputs.kite_position, **at_the_ground, **{name: kite.get(name) for name in FELT})
    winch.set(set_speed=controller.get("set_speed"), **at_the_ground)
    return given


def test_a_pumping_cycle_keeps_its_energy():
    tether, models, outputs, wind = flying()
    controller, winch = models["FlightController"], models["Winch"]
    audit, marks, before = EnergyAudit(tether), [], 1.0
    while len(marks) < 2:
        given = exchanged(models, outputs)
        assert all(model.step(STEP) for model in models.values())
        outputs = audit.step(STEP, wind_velocity=wind, **given)
        if before == 2.0 != controller.get("phase"):  # reeled in: a cycle ends
            marks.append((dict(audit.work), audit.residual, audit.now.total, winch.get("energy")))
        before = controller.get("phase")
        assert controller.time < 150.0
    (start, first, stored, drum), (end, last, stored_now, drum_now) = marks
    work = {name: end[name] - start[name] for name in POWERS}
    harvest = drum_now - drum
    assert harvest > 20e3  # J
    # the audit takes load and speed as held over a step, the tether continues them: 1.0 % at 20 ms, 0.5 % at 10, 0.25 % at 5
    assert abs(last - first) < 0.01 * harvest
    assert abs(stored_now - stored) < 0.05 * harvest  # a cycle ends as it began
    # what the winch and the material take is the work at the drum, T ds, up to strains of 0.5 %
    assert -(work["winch_power"] + work["material_power"]) == pytest.approx(harvest, rel=0.01)
    assert min(work["drag_loss"], work["damping_loss"]) > 0.0
    # and what the kite gives beyond that goes into air and dampers: the balance, written out
    spent = harvest + work["drag_loss"] + work["damping_loss"] + stored_now - stored - work["wind_power"]
    assert work["kite_power"] + work["ground_power"] == pytest.approx(spent, rel=0.01)
