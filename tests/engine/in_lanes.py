"""Models that fits follow in the processor's lanes, with values beside a natural frequency and viscous drag; the release of their swings."""

SMOOTH = {
    "viscous": {},
    "viscous+sensor_zero": {"sensor_zero": 0.01},
    "viscous+sensor_zero+sensor_gain": {"sensor_zero": 0.01, "sensor_gain": 0.02},
    "viscous+constant_torque": {"constant_torque": 0.3},
    "viscous+cubic_stiffness": {"cubic_stiffness": 0.4},
}
DIRECTED = {
    "quadratic_drag": {"quadratic_coefficient": 0.02},
    "viscous+constant_coulomb": {"constant_friction": 0.1},
    "viscous+quadratic_drag+load_coulomb+sensor_zero": {
        "quadratic_coefficient": 0.01,
        "load_friction": 0.001,
        "sensor_zero": 0.01,
    },
    "viscous+quadratic_drag+constant_torque": {"quadratic_coefficient": 0.01, "constant_torque": 0.3},
}
RELEASE = 0.5, 0.2  # rad, rad/s
