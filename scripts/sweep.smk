"""The cells of long calculations on local cores and GPUs or on a cluster (Snakemake 7).

    snakemake -s scripts/sweep.smk --cores 2 --config accuracy="--quick" out=sweep
    snakemake -s scripts/sweep.smk --cores 2 --config power="protocols/task2.toml --effect 0.7" out=sweep
    snakemake -s scripts/sweep.smk --cores 2 --config fit="pilot.db --resamples 100000" out=sweep
    snakemake -s scripts/sweep.smk --cores 2 --config compare="pilot.db" out=sweep

docs/results.md and docs/statistics.md show complete runs; docs/scale.md says what many cells cost. Keys of
--config (with defaults):

accuracy  options of vip-bench accuracy; without this key no cell of it runs
power     protocol and options of vip-stats power; without this key no cell of it runs
fit       database and options of vip-stats fit-ptpe; without this key no cell of it runs
compare   database and options of vip-stats compare-models; without this key no cell of it runs
out       folder of shards and results (sweep)
bin       folder of the programs (the folders of PATH)
batch     number of cells for each job (1)
retries   how often a job that failed or was killed is repeated (2)
minutes   time limit of a job on a cluster, minutes (8)
gpus      with accuracy="... --backend cuda": number of GPUs of a machine, each for one job at a time (those
          of CUDA_VISIBLE_DEVICES, or all that nvidia-smi lists)
threads   number of threads of a timed cell (--cores, with GPUs divided by their number); required on a
          cluster
slurm     further options of sbatch for timed cells (--exclusive, with GPUs --gres=gpu:1)
"""

import os
import shlex
import subprocess

from snakemake.exceptions import WorkflowError

OUT = str(config.get("out", "sweep"))
BATCH = int(config.get("batch", 1))
RETRIES = int(config.get("retries", 2))
MINUTES = int(config.get("minutes", 8))


def program(name):
    return shlex.quote(os.path.join(config["bin"], name)) if "bin" in config else name


def batches_of(command):
    """The listed keys, BATCH for each job. A job is named by its first key and the number of its keys."""
    listed = subprocess.run(f"{command} --list", shell=True, text=True, stdout=subprocess.PIPE)
    if listed.returncode != 0:
        raise WorkflowError(f"{command} --list: exit status {listed.returncode}")
    keys = [line.split()[0] for line in listed.stdout.splitlines()]
    batches = [keys[i : i + BATCH] for i in range(0, len(keys), BATCH)]
    return {f"{batch[0]}_{len(batch)}": batch for batch in batches}


def done_of(kind, batches):
    return expand(f"{OUT}/{kind}/done/{{batch}}", batch=batches)


def shards_of(kind, batches, ending):
    return [f"{OUT}/{kind}/shards/{key}.{ending}" for batch in batches.values() for key in batch]


def gpus_of_machine():
    """The GPUs for the cells of accuracy, as CUDA_VISIBLE_DEVICES names them; empty: they run on the CPU."""
    words = shlex.split(str(config.get("accuracy") or ""))
    cuda = "--backend=cuda" in words or ("--backend", "cuda") in zip(words, words[1:])
    if not cuda:
        if "gpus" in config:
            raise WorkflowError("gpus= is for accuracy with --backend cuda: add that, or leave gpus= out")
        return []
    visible = os.environ.get("CUDA_VISIBLE_DEVICES", "")
    found = [one for one in visible.split(",") if one]
    if not found and "gpus" in config:
        found = [str(one) for one in range(int(config["gpus"]))]
    if not found:
        try:
            listed = subprocess.run(["nvidia-smi", "-L"], text=True, capture_output=True).stdout
        except OSError:
            listed = ""
        found = [str(one) for one in range(sum(line.startswith("GPU ") for line in listed.splitlines()))]
    found = found[: int(config.get("gpus", len(found)))]
    if not found:
        raise WorkflowError("no GPU is found for --backend cuda: give their number with gpus=")
    return found


# Snakemake deletes the outputs of a job that fails. A shard is therefore not declared as an output: finished
# cells remain, and the programs skip a cell whose shard already holds it.
EACH = (
    "for key in {params.cells}; do "
    "{params.command} --cell $key --out {params.shards}/$key.{params.ending}; done"
)

results = []

if "accuracy" in config:
    accuracy = f"{program('vip-bench')} accuracy {config['accuracy'] or ''}"
    gpus = gpus_of_machine()
    with_gpu = f"bash {shlex.quote(os.path.join(workflow.basedir, 'with_gpu.sh'))} {','.join(gpus)} "
    accuracy_batches = batches_of(accuracy)
    results += [f"{OUT}/accuracy/{name}" for name in ("accuracy.html", "sweep.db", "settings.csv")]
    # A timed job on the CPU runs alone on its machine: it gets all cores of this machine, or a whole node of
    # a cluster. One on a GPU has this GPU for itself and its share of the cores. The number of threads is
    # stored with each time, so that the table is made with the same number.
    timed_threads = int(
        config["threads"] if "threads" in config else max(1, workflow.cores // max(1, len(gpus)))
    )
    submitted = str(config.get("slurm", "--gres=gpu:1" if gpus else "--exclusive"))
    gpu = 1 if gpus else 0
    if gpus and workflow.global_resources["_nodes"] is None:  # on this machine
        workflow.global_resources.setdefault("gpu", len(gpus))

    rule accuracy_cells:
        output:
            touch(f"{OUT}/accuracy/done/{{batch}}"),
        params:
            cells=lambda wildcards: accuracy_batches[wildcards.batch],
            command=(with_gpu if gpus else "") + accuracy,
            shards=f"{OUT}/accuracy/shards",
            ending="db",
            machine=timed_threads,  # with another number of threads the cells run again
        threads: timed_threads
        resources:
            runtime=MINUTES,
            slurm_extra=submitted,
            gpu=gpu,
            nvidia_gpu=gpu,
        retries: RETRIES
        shell:
            EACH

    rule accuracy_table:
        input:
            done_of("accuracy", accuracy_batches),
        output:
            db=f"{OUT}/accuracy/sweep.db",
            csv=f"{OUT}/accuracy/settings.csv",
            prices=f"{OUT}/accuracy/prices.csv",
            markdown=f"{OUT}/accuracy/accuracy.md",
            html=f"{OUT}/accuracy/accuracy.html",
        params:
            merge=f"{program('vip-bench')} accuracy merge",
            table=f"{accuracy} --table",
            shards=shards_of("accuracy", accuracy_batches, "db"),
        threads: timed_threads
        resources:
            slurm_extra=submitted,
        shell:
            "{params.merge} --db {output.db} {params.shards} && "
            "{params.table} --db {output.db} --csv {output.csv} --prices-csv {output.prices} "
            "--markdown {output.markdown} --html {output.html}"


# Calculations of vip-stats: the command, and the results that its `merge` writes.
for kind, command, endings in (
    ("power", "power", ("json", "csv", "svg")),
    ("fit", "fit-ptpe", ("json", "svg")),
    ("compare", "compare-models", ("json",)),
):
    if kind not in config:
        continue
    whole = f"{program('vip-stats')} {command} {config[kind] or ''}"
    batches = batches_of(whole)
    files = {ending: f"{OUT}/{kind}/{kind}.{ending}" for ending in endings}
    results += files.values()

    rule:
        name:
            f"{kind}_cells"
        output:
            touch(f"{OUT}/{kind}/done/{{batch}}"),
        params:
            cells=lambda wildcards, batches=batches: batches[wildcards.batch],
            command=whole,
            shards=f"{OUT}/{kind}/shards",
            ending="json",
        resources:
            runtime=MINUTES,
        retries: RETRIES
        shell:
            EACH

    rule:
        name:
            f"{kind}_result"
        input:
            done_of(kind, batches),
        output:
            **files,
        params:
            merge=f"{program('vip-stats')} {command} merge {config[kind] or ''}",
            files=" ".join(f"--{ending} {file}" for ending, file in files.items()),
            shards=shards_of(kind, batches, "json"),
            list=f"{OUT}/{kind}/shards.txt",  # a command line is too short for thousands of names
        run:
            with open(params.list, "w") as file:
                file.writelines(f"{shard}\n" for shard in params.shards)
            shell("{params.merge} {params.files} --shards-in {params.list}")


if not results:
    raise WorkflowError("--config names none of accuracy, power, fit and compare: there is nothing to run")


rule all:
    default_target: True
    input:
        results,
