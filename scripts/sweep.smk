"""The cells of `vip-bench accuracy` and of `vip-stats power` on local cores or on a cluster (Snakemake 7).

    snakemake -s scripts/sweep.smk --cores 2 --config accuracy="--quick" out=sweep
    snakemake -s scripts/sweep.smk --cores 2 --config power="protocols/task2.toml --effect 0.7" out=sweep

docs/results.md and docs/statistics.md show complete runs. Keys of --config (with defaults):

accuracy  options of vip-bench accuracy; without this key no cell of it runs
power     protocol and options of vip-stats power; without this key no cell of it runs
out       folder of shards and results (sweep)
bin       folder of the programs (the folders of PATH)
batch     number of cells for each job (1)
retries   how often a job that failed or was killed is repeated (2)
minutes   time limit of a job on a cluster, minutes (8)
threads   number of threads of a timed cell (--cores); required on a cluster
slurm     further options of sbatch for timed cells (--exclusive)
"""

import os
import shlex
import subprocess

from snakemake.exceptions import WorkflowError

OUT = str(config.get("out", "sweep"))
BATCH = int(config.get("batch", 1))


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


# Snakemake deletes the outputs of a job that fails. A shard is therefore not declared as an output: finished
# cells remain, and the programs skip a cell whose shard already holds it.
EACH = (
    "for key in {params.cells}; do "
    "{params.command} --cell $key --out {params.shards}/$key.{params.ending}; done"
)

results = []

if "accuracy" in config:
    accuracy = f"{program('vip-bench')} accuracy {config['accuracy'] or ''}"
    accuracy_batches = batches_of(accuracy)
    results += [f"{OUT}/accuracy/{name}" for name in ("accuracy.html", "sweep.db", "settings.csv")]
    # A timed job runs alone on its machine: it gets all cores of this machine, or a whole node of a cluster.
    # The number of threads is stored with each time, so that the table is made with the same number.
    timed_threads = int(config["threads"] if "threads" in config else workflow.cores)
    exclusive = str(config.get("slurm", "--exclusive"))

    rule accuracy_cells:
        output:
            touch(f"{OUT}/accuracy/done/{{batch}}"),
        params:
            cells=lambda wildcards: accuracy_batches[wildcards.batch],
            command=accuracy,
            shards=f"{OUT}/accuracy/shards",
            ending="db",
            machine=timed_threads,  # with another number of threads the cells run again
        threads: timed_threads
        resources:
            runtime=int(config.get("minutes", 8)),
            slurm_extra=exclusive,
        retries: int(config.get("retries", 2))
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
            slurm_extra=exclusive,
        shell:
            "{params.merge} --db {output.db} {params.shards} && "
            "{params.table} --db {output.db} --csv {output.csv} --prices-csv {output.prices} "
            "--markdown {output.markdown} --html {output.html}"


if "power" in config:
    power = f"{program('vip-stats')} power {config['power'] or ''}"
    power_batches = batches_of(power)
    results += [f"{OUT}/power/power.{ending}" for ending in ("json", "csv", "svg")]

    rule power_cells:
        output:
            touch(f"{OUT}/power/done/{{batch}}"),
        params:
            cells=lambda wildcards: power_batches[wildcards.batch],
            command=power,
            shards=f"{OUT}/power/shards",
            ending="json",
        resources:
            runtime=int(config.get("minutes", 8)),
        retries: int(config.get("retries", 2))
        shell:
            EACH

    rule power_result:
        input:
            done_of("power", power_batches),
        output:
            json=f"{OUT}/power/power.json",
            csv=f"{OUT}/power/power.csv",
            svg=f"{OUT}/power/power.svg",
        params:
            merge=f"{program('vip-stats')} power merge {config['power'] or ''}",
            shards=shards_of("power", power_batches, "json"),
        shell:
            "{params.merge} --json {output.json} --csv {output.csv} --svg {output.svg} {params.shards}"


if not results:
    raise WorkflowError("--config names neither accuracy nor power, so that there is nothing to run")


rule all:
    default_target: True
    input:
        results,
