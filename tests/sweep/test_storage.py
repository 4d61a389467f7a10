"""A sweep whose jobs share no file system: all they pass on goes through an S3 server, here one on this machine."""

import os
import subprocess
import sys

import boto3
import numpy as np
import pytest
import xarray as xr
from moto.server import ThreadedMotoServer

SWEEP = """\
recordings: null
simulation: {simulated: []}
sweeps:
  small:
    computes: identification
    axes:
      simulation.simulated: [viscous, load_coulomb]
      simulation.snr: [20, 50]
    settings: {simulation.duration_s: 2.5, simulation.start: free}
    realizations: 20
    chunk: 30
"""
KEYS = {"AWS_ACCESS_KEY_ID": "any", "AWS_SECRET_ACCESS_KEY": "any", "AWS_DEFAULT_REGION": "us-east-1",
        "SNAKEMAKE_STORAGE_S3_ACCESS_KEY": "any", "SNAKEMAKE_STORAGE_S3_SECRET_KEY": "any"}  # fmt: skip


@pytest.fixture
def bucket(monkeypatch):
    """An empty bucket: (client, address of the server)."""
    for name, value in KEYS.items():
        monkeypatch.setenv(name, value)
    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
    server.start()
    address = "http://{}:{}".format(*server.get_host_and_port())
    client = boto3.client("s3", endpoint_url=address)
    client.create_bucket(Bucket="sweeps")
    yield client, address
    server.stop()


@pytest.mark.slow("a sweep")
def test_a_sweep_runs_over_a_storage_and_is_found_there_from_another_machine(root, bucket, tmp_path):
    client, address = bucket

    def run(folder):
        folder.mkdir(exist_ok=True)
        (folder / "sweep.yaml").write_text(SWEEP)
        command = [
            sys.executable, "-m", "snakemake", "-c2", "sweep", "--configfile", folder / "sweep.yaml", "--directory", folder,
            "--default-storage-provider", "s3", "--default-storage-prefix", "s3://sweeps", "--storage-s3-endpoint-url", address,
            "--shared-fs-usage", "none",
        ]  # fmt: skip
        done = subprocess.run(
            list(map(str, command)), cwd=root, env=os.environ, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300
        )  # fmt: skip
        assert done.returncode == 0, done.stdout
        return done.stdout

    def chunks():
        listed = client.list_objects_v2(Bucket="sweeps")["Contents"]
        return {one["Key"]: one["LastModified"] for one in listed if "/chunks/" in one["Key"]}

    first = run(tmp_path / "here")
    assert first.count("computing chunk") == 3 and "80 draws, all there, from 3 chunks" in first
    before = chunks()
    assert len(before) == 3
    assert not list(
        (tmp_path / "here/results/sweeps/small").glob("chunks/*")
    )  # nothing but the storage has them
    client.download_file("sweeps", "results/sweeps/small/sweep.nc", str(tmp_path / "sweep.nc"))
    data = xr.load_dataset(tmp_path / "sweep.nc")
    assert data["norm"].notnull().all()
    for model in (
        data["norm"].transpose("fitted", ...).values
    ):  # a larger model may end where a smaller one does
        assert np.unique(model).size == model.size, "two draws alike"
    client.download_file("sweeps", "results/sweeps.html", str(tmp_path / "sweeps.html"))
    assert (tmp_path / "sweeps.html").read_text().count("data:image/svg+xml") == 3

    assert "computing chunk" not in run(tmp_path / "there")
    assert chunks() == before
