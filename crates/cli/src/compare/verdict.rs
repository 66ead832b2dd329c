//! Whether two label sets are equal, told.

use occlabel_core::{Fault, printable};
use occlabel_dialects::KeyframeKey;
use occlabel_evaluate::compare::Comparer;
use serde_json::json;

use crate::args::CompareArgs;
use crate::compare::found::{DifferingKeyframe, Found};
use crate::console::Console;
use crate::exit::{Outcome, Stop};
use crate::label_pairs::LabelPairs;

/// Prints how the sets differ; fails if they do beyond the tolerance.
pub(crate) fn tell(
    args: &CompareArgs,
    pairs: &LabelPairs,
    found: &Found,
    comparer: &Comparer,
    console: &Console,
) -> Result<Outcome, Stop> {
    let faults = faults(args, pairs, found);
    let comparison = found.difference.comparison(comparer);
    let worst = &found.worst[..found.worst.len().min(args.worst)];
    if args.json {
        console.result(
            &json!({
                "equal": faults.is_empty(),
                "tolerance": args.tolerance,
                "only_a": names(&pairs.only_a),
                "only_b": names(&pairs.only_b),
                "arrays_lacking": found.lacking,
                "comparison": comparison,
                "worst": worst,
            })
            .to_string(),
        );
    } else {
        console.results(comparison.table().as_bytes());
        console.results(worst_table(worst).as_bytes());
    }
    if faults.is_empty() { Ok(Outcome::Complete) } else { Err(Stop::Failed(faults)) }
}

fn faults(args: &CompareArgs, pairs: &LabelPairs, found: &Found) -> Vec<Fault> {
    let b = args.b.display().to_string();
    let absent = absent(&b, "absent", "the keyframes of the first set", &pairs.only_a);
    let more = self::absent(&b, "more", "no keyframe that the first set lacks", &pairs.only_b);
    let differs = found.worst.first().filter(|worst| worst.differing_share > args.tolerance);
    let differs = differs.map(|worst| {
        let expected = format!("at most {} of the voxels to differ", args.tolerance);
        let (share, count) = (worst.differing_share, worst.differing);
        Fault::new("labels-differ", &b, expected, format!("{share} ({count} voxels)"))
            .record(format!("{}/{}", worst.scene, worst.keyframe))
    });
    let nothing = (pairs.both.is_empty() && pairs.only_a.is_empty() && pairs.only_b.is_empty())
        .then(|| Fault::new("no-keyframes", &b, "keyframes to compare", "none in either set"));
    let lacking = found.lacking.iter().cloned().collect::<Vec<_>>().join(", ");
    let lacking = (!lacking.is_empty() && !args.shared_arrays).then(|| {
        Fault::new("arrays-differ", &b, "the arrays of the first set", lacking)
            .hint("--shared-arrays compares those that both have")
    });
    [absent, more, lacking, differs, nothing].into_iter().flatten().collect()
}

fn absent(place: &str, what: &str, expected: &str, keys: &[KeyframeKey]) -> Option<Fault> {
    let first = names(keys).into_iter().next()?;
    let found = format!("{} {what}, the first {first}", keys.len());
    Some(Fault::new("keyframes-differ", place, expected, found))
}

fn names(keys: &[KeyframeKey]) -> Vec<String> {
    keys.iter().map(|key| format!("{}/{}", key.scene, key.token)).collect()
}

fn worst_table(worst: &[DifferingKeyframe]) -> String {
    let row = |one: &DifferingKeyframe| {
        let miou = one.miou.map_or("-".to_owned(), |miou| format!("{miou:.4}"));
        let name = printable(&format!("{}/{}", one.scene, one.keyframe));
        format!("  {:>10.6}{:>10}{miou:>10}  {name}\n", one.differing_share, one.differing)
    };
    let heading =
        format!("\n  {:>10}{:>10}{:>10}  Keyframes that differ most\n", "share", "voxels", "mIoU");
    let rows: String = worst.iter().map(row).collect();
    if rows.is_empty() { rows } else { heading + &rows }
}
