"""A real cluster, of which nodes and workers are lost."""

import json
import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from processes import halt, is_gone, labelling, wait_for

PROGRAM = os.environ.get("OCCLABEL_PROGRAM") or shutil.which("occlabel")
SCENES = int(os.environ.get("OCCLABEL_RAY_SCENES", "6"))
VOXEL_M = os.environ.get("OCCLABEL_RAY_VOXEL_M", "0.2")
"""A scene takes some 0.3 s of CPU at 0.4 m, 3 s at 0.2 m, 16 s at 0.1 m."""

needs_program = pytest.mark.skipif(
    PROGRAM is None, reason="there is no occlabel, nor OCCLABEL_PROGRAM"
)


@pytest.mark.long
def test_a_lost_node_and_a_poisoned_scene(nodes, program, tmp_path):
    """Each scene notes that it was begun and that it ended; shard 3 never does."""
    scenes = [f"s{at}" for at in range(8)]
    does = f"""
        cd {tmp_path}
        {plan_of(scenes)}
        shard=${{9%/*}}
        echo $shard >> begun
        sleep 1
        test "$shard" != 3 || {{ echo "scene 3 is broken" >&2; exit 1; }}
        echo $shard >> ended"""
    driver = drive(nodes, program(does), tmp_path)
    wait_for(lambda: len(lines(tmp_path / "begun")) >= 3)
    nodes.remove_node(nodes.further[1], allow_graceful=False)
    nodes.add()
    assert driver.wait(100) == 3
    told = json.loads((tmp_path / "ray.json").read_text())
    assert told["set_aside"] == {"s3": "scene 3 is broken"}
    assert (told["complete"], told["tried_again"]["s3"]) == (7, 3)
    assert told["lost"] >= 1, "a scene was lost with its node"
    assert sorted(set(lines(tmp_path / "ended"))) == [str(at) for at in range(8) if at != 3]


@pytest.mark.long
def test_places_that_are_not_fit_are_told_and_not_used(nodes, program, tmp_path):
    """The driver and the first place have one version of the program, the others another."""
    does = f"""
        cd {tmp_path}
        case $1 in --version)
            mkdir driver || mkdir first || {{ echo occlabel 2; exit; }}
            echo occlabel 1
            exit ;;
        esac
        {plan_of(["a", "b", "c", "d"])}
        sleep 2"""
    driver = drive(nodes, program(does), tmp_path)
    assert driver.wait(100) == 0, driver.told()
    told = json.loads((tmp_path / "ray.json").read_text())
    assert (told["complete"], told["places"], told["tries"]) == (4, 1, 4)
    assert driver.told().count("not used: ") == 1
    assert "/occlabel is occlabel 2, the driver's is occlabel 1\n" in driver.told()


@pytest.mark.long
def test_without_a_fit_place_the_run_is_refused(nodes, program, tmp_path):
    does = f"""
        cd {tmp_path}
        case $1 in --version) mkdir driver || exit 1; exit ;; esac
        {plan_of(["a", "b"])}"""
    driver = drive(nodes, program(does), tmp_path)
    assert driver.wait(100) == 2
    assert driver.told().endswith("error: no place is fit to label\n")


@needs_program
def test_a_cluster_gives_the_tree_of_one_process(nodes, tmp_path):
    """Two workers are killed amid a scene, and a scene is broken: all else is as one has it."""
    log, alone, together = (tmp_path / name for name in ("log", "alone", "together"))
    scenes = simulate(log)
    poisoned = scenes[SCENES // 2]
    others = [scene for scene in scenes if scene != poisoned]
    command("label", *flags(log), "--scenes", ",".join(others), "--output", alone)
    cut_a_sweep(log, poisoned)

    driver = drive(nodes, PROGRAM, together, flags(log))
    first = kill_a_worker(log, together, scenes, spared=[poisoned])
    second = kill_a_worker(log, together, scenes, spared=[poisoned, first])
    assert driver.wait(60 + 30 * SCENES) == 3, driver.told()
    shard = f"{scenes.index(poisoned)}-of-{SCENES}"
    left = [f"journal.{shard}.jsonl", f"run.{shard}.json"]
    ours = files_under(together)
    assert [ours.pop(name) for name in left][0] == b"", "nothing of it was finished"
    assert ours == files_under(alone)
    told = json.loads((tmp_path / "ray.json").read_text())
    assert told["tried_again"] == {first: 2, second: 2, poisoned: 3}
    assert list(told["set_aside"]) == [poisoned]
    assert (told["complete"], told["lost"], told["places"]) == (SCENES - 1, 2, 3)
    assert f"set aside: {poisoned}: error: " in driver.told()
    command("verify", together)
    print(json.dumps(told, indent=1))


@needs_program
@pytest.mark.long
def test_an_interrupted_driver_ends_its_scenes_and_goes_on_later(nodes, tmp_path):
    log, output = tmp_path / "log", tmp_path / "labels"
    simulate(log)
    more = ["--shards", max(1, SCENES // 2)]
    driver = drive(nodes, PROGRAM, output, flags(log), more)
    begun = wait_for(lambda: list(labelling(PROGRAM, log)))
    os.kill(driver.pid, signal.SIGINT)
    assert driver.wait(40) == 130
    assert driver.told().endswith("interrupted: the same command goes on from here\n")
    assert wait_for(lambda: all(is_gone(process.pid) for process in begun))
    assert not list(labelling(PROGRAM, log))
    again = drive(nodes, PROGRAM, output, flags(log), more)
    assert again.wait(100) == 0, again.told()
    told = json.loads((tmp_path / "ray.json").read_text())
    assert told["complete"] == max(1, SCENES // 2)
    command("verify", output)
    labelled = json.loads((output / "manifest.json").read_text())["scenes"]
    assert len(labelled) == SCENES


def kill_a_worker(log, tree, scenes, spared):
    """Kills a Ray worker whose program has finished a keyframe of a scene and not the scene.

    The program is halted while that is looked at, so that it is so when its worker is killed.
    """

    def kill():
        for process in labelling(PROGRAM, log):
            shard = process.words[process.words.index("--shard") + 1]
            scene = scenes[int(shard.split("/")[0])]
            if scene not in spared and halt(process):
                if is_amid(tree, shard):
                    os.kill(process.parent, signal.SIGKILL)
                    return scene, process.pid
                os.kill(process.pid, signal.SIGCONT)
        return None

    scene, pid = wait_for(kill)
    wait_for(lambda: is_gone(pid))
    return scene


def is_amid(tree, shard):
    name = shard.replace("/", "-of-")
    finished = lines(tree / f"journal.{name}.jsonl")
    return len(finished) > 0 and not (tree / f"manifest.{name}.json").exists()


def drive(nodes, program, output, flags=(), more=()):
    """Begins a driver, which reports to `ray.json` beside the output."""
    output = Path(output)
    folder = output if not flags else output.parent
    line = [sys.executable, "-m", "occlabel_ray", "--address", nodes.address]
    line += ["--program", program, "--output", output, "--report", folder / "ray.json", *more]
    told = (folder / "told").open("w+")
    package = str(Path(__file__).parents[1])
    driver = subprocess.Popen(
        [*map(str, line), "--", *(flags or ["--format", "any"])],
        stderr=told,
        env={**os.environ, "PYTHONPATH": package},
    )
    driver.told = lambda: (folder / "told").read_text()
    return driver


def plan_of(scenes):
    """What a program does that plans such scenes, and merges them."""
    each = {"keyframes": 40, "cpu_seconds": 1.0, "memory_bytes": 1 << 20}
    plan = [
        json.dumps({"scene": scene, "shard": f"{at}/{len(scenes)}", **each})
        for at, scene in enumerate(scenes)
    ]
    told = "\n".join(plan)
    return f"""
        case $1 in
            --version) echo occlabel 1; exit ;;
            merge-manifests) exit ;;
            plan) cat <<'END'
{told}
END
                exit ;;
        esac"""


def simulate(log):
    """The scenes of a log, which is made."""
    world = ["--world", "street", "--scenes", SCENES, "--format", "nuscenes", "--images", "none"]
    command("simulate", *world, "--output", log)
    return sorted(row["name"] for row in table(log, "scene"))


def cut_a_sweep(log, scene):
    """Breaks the sweep of a scene's first keyframe."""
    [token] = [row["first_sample_token"] for row in table(log, "scene") if row["name"] == scene]
    [file, *_] = [
        row["filename"]
        for row in table(log, "sample_data")
        if row["sample_token"] == token and row["filename"].endswith(".pcd.bin")
    ]
    os.truncate(log / file, 7)


def table(log, name):
    [path] = log.glob(f"*/{name}.json")
    return json.loads(path.read_text())


def flags(log):
    return ["--format", "nuscenes", "--input", str(log), "--set", f"grid.voxel_size_m={VOXEL_M}"]


def command(*arguments):
    line = [PROGRAM, *map(str, arguments)]
    return subprocess.run(line, check=True, capture_output=True, text=True).stdout


def files_under(tree):
    """All files of a tree but the report, which tells times."""
    files = {path.relative_to(tree): path for path in sorted(tree.rglob("*")) if path.is_file()}
    return {
        str(name): path.read_bytes() for name, path in files.items() if name.name != "report.json"
    }


def lines(path):
    return path.read_text().splitlines() if path.exists() else []
