"""Start of scripts on several processes, with the launcher that belongs to the interpreter of the tests."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

# Containers run as root, and have fewer cores than a test has processes: Open MPI 4, then 5, then 6.
ENVIRONMENT = {
    "OMP_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",  # else they wait for one busy core while another is free
    "OMPI_MCA_btl": "^tcp",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    "PRTE_MCA_mapby": ":oversubscribe",
    "PRTE_MCA_hwloc_default_binding_policy": "none",
}


SCRIPTS = Path(__file__).parent
OWN = Path(sys.executable).with_name("mpiexec")  # the launcher of the wheel; that of Debian is on the path
PROCESSES = 2 if OWN.exists() else 3  # MPICH of the wheel spins while it waits, and test machines have 2 cores


def launcher():
    """Find the launcher that belongs to the interpreter."""
    return str(OWN) if OWN.exists() else shutil.which("mpirun")


def start(arguments, processes, timeout=1500):
    """Run a script with this interpreter; kill processes that do not end."""
    tests = str(Path(__file__).parent)
    # without the C environment, into which MPI has written
    environment = dict(os.environ) | ENVIRONMENT
    environment["PYTHONPATH"] = os.pathsep.join([tests, str(Path(tests).parent), environment.get("PYTHONPATH", "")])
    several = [launcher(), "-n", str(processes)] if processes > 1 else []
    command = [*several, sys.executable, *map(str, arguments)]
    with subprocess.Popen(
        command, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True
    ) as process:
        try:
            output, _ = process.communicate(timeout=timeout)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            output, _ = process.communicate()
            raise AssertionError(f"{command} did not end:\n{output}") from None
    assert process.returncode == 0, output
    return output
