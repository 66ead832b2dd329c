//! Keyframes of truth that have no prediction.

use std::collections::BTreeSet;

use occlabel_core::Fault;
use occlabel_dialects::KeyframeKey;

use crate::args::EvaluateArgs;
use crate::label_pairs::LabelPairs;

/// How many keyframes a message names.
const NAMED: usize = 3;

/// What is missing, if it may be.
///
/// # Errors
/// If a scene that is asked for is not in the truth, a prediction is missing and that is not
/// allowed, or nothing is left to score.
pub(crate) fn check(pairs: &LabelPairs, args: &EvaluateArgs) -> Result<Option<Fault>, Fault> {
    check_scenes(pairs.a.keyframes(), args)?;
    if pairs.only_a.is_empty() {
        return Ok(None);
    }
    let missing = fault(&pairs.only_a, pairs.both.len(), args);
    match args.allow_missing && !pairs.both.is_empty() {
        true => Ok(Some(missing)),
        false => Err(missing.hint("score the others with --allow-missing")),
    }
}

/// The name of a keyframe in messages.
pub(crate) fn name(key: &KeyframeKey) -> String {
    if key.scene.is_empty() { key.token.clone() } else { format!("{}/{}", key.scene, key.token) }
}

fn fault(missing: &[KeyframeKey], others: usize, args: &EvaluateArgs) -> Fault {
    let all = missing.len() + others;
    let names: Vec<String> = missing.iter().take(NAMED).map(name).collect();
    let more = if missing.len() > NAMED { ", …" } else { "" };
    let place = args.prediction.display().to_string();
    let expected = format!("a prediction for each of {all} keyframes");
    let found = format!("{} missing: {}{more}", missing.len(), names.join(", "));
    Fault::new("prediction-missing", place, expected, found)
}

fn check_scenes(keyframes: &[KeyframeKey], args: &EvaluateArgs) -> Result<(), Fault> {
    let scenes: BTreeSet<&str> = keyframes.iter().map(|key| key.scene.as_str()).collect();
    let Some(strange) = args.scenes.iter().find(|scene| !scenes.contains(scene.as_str())) else {
        return Ok(());
    };
    let known: Vec<&str> = scenes.into_iter().take(2 * NAMED).collect();
    let expected = format!("a scene of the truth, such as {}", known.join(", "));
    let place = args.truth.display().to_string();
    Err(Fault::new("evaluate-scene", place, expected, format!("`{strange}`")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    use crate::args::{Cli, Command};

    fn keys(names: &[(&str, &str)]) -> Vec<KeyframeKey> {
        let key = |(scene, token): &(&str, &str)| KeyframeKey {
            scene: (*scene).into(),
            token: (*token).into(),
        };
        names.iter().map(key).collect()
    }

    fn args(more: &[&str]) -> EvaluateArgs {
        let line = ["occlabel", "evaluate", "--truth", "t", "--prediction", "p"];
        match Cli::try_parse_from([&line[..], more].concat()).expect("a good line").command {
            Command::Evaluate(args) => *args,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_is_missing_is_counted_and_named() {
        let missing = keys(&[("a", "1"), ("", "2"), ("a", "4"), ("a", "5")]);
        let text = fault(&missing, 1, &args(&[])).to_string();
        assert!(text.contains("4 missing: a/1, 2, a/4, …") && text.contains("of 5"), "{text}");
    }

    #[test]
    fn a_scene_that_is_not_there_is_refused() {
        let keys = keys(&[("a", "1"), ("b", "2")]);
        assert!(check_scenes(&keys, &args(&["--scenes", "b"])).is_ok());
        let fault = check_scenes(&keys, &args(&["--scenes", "b,c"])).unwrap_err().to_string();
        assert!(fault.contains("`c`") && fault.contains("a, b"), "{fault}");
    }
}
