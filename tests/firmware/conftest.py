"""The firmware's tests need programs that emulate it; without them they are skipped, loudly."""

import board as boards
import pytest

pytest.register_assert_rewrite("truth")


@pytest.fixture(scope="module", autouse=True)
def emulator():
    if lacking := boards.lacking():
        pytest.skip(
            f"NOT TESTED: the firmware cannot be emulated, {', '.join(lacking)} not here (tools/install-test-tools)"
        )
