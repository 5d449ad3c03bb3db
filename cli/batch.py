"""`panorama batch VERB SET… --into FOLDER`: one verb on many sets; a bad one doesn't stop the others."""

from .messages import complain, one_line, warn

SUMMARY = "do one verb on many sets; go on after a bad one and say so at the end"


def run(arguments, progress):
    """Do the verb on every set -> {"verb", "done", "failed"}, exit status: 2 if any failed."""
    outputs = _outputs(arguments)
    arguments.into.mkdir(parents=True, exist_ok=True)
    done, failed = [], []
    for set_path, output in outputs.items():
        progress.seconds.clear()
        try:
            result = arguments.module.run(set_path, output, arguments, progress)
        except (ValueError, OSError) as error:
            complain(f"batch {arguments.batch_verb}", one_line(error))
            failed.append({"set": str(set_path), "error": one_line(error)})
        else:
            if not arguments.json:
                warn(f"batch {arguments.batch_verb}", set_path, result)
            done.append({"set": str(set_path), "output": str(output), "result": result})
    return {"verb": arguments.batch_verb, "done": done, "failed": failed}, 2 if failed else 0


def _outputs(arguments):
    """The file of each set in the folder, by the set's name. Raises ValueError where two would share one."""
    suffix, frames = arguments.module.SUFFIX, getattr(arguments, "frames", None)
    if frames is not None:
        suffix = f"_####{suffix}"
    outputs = {path: arguments.into / f"{path.stem}{suffix}" for path in arguments.sets}
    owners = {}
    for path, output in outputs.items():
        other = owners.setdefault(str(output).casefold(), path)
        if other != path:
            raise ValueError(f"sets {other} and {path} would both write {output}: name them differently")
    return outputs


def describe(result):
    """One line per set that is done, and the sum."""
    count = len(result["done"]) + len(result["failed"])
    return [
        *(f"{item['set']} → {item['output']}" for item in result["done"]),
        f"{len(result['done'])} of {count} sets done"
        + (f", {len(result['failed'])} failed" if result["failed"] else ""),
    ]
