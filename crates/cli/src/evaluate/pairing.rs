//! Which prediction belongs to which truth.

use std::collections::{BTreeMap, BTreeSet};

use occlabel_core::Fault;
use occlabel_dialects::{KeyframeKey, LabelSet};

use crate::args::EvaluateArgs;

/// How many keyframes a message names.
const NAMED: usize = 3;

/// Keyframes of truth with their predictions, in the truth's order.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Pairing {
    pub(crate) pairs: Vec<(KeyframeKey, KeyframeKey)>,
    /// Keyframes of truth without a prediction.
    pub(crate) missing: Vec<KeyframeKey>,
    /// How many predictions have no truth.
    pub(crate) unused: usize,
}

impl Pairing {
    /// Pairs the keyframes of two label sets.
    ///
    /// # Errors
    /// If a scene that is asked for is not there, a token alone does not tell which keyframe is
    /// meant, nothing pairs up, or a prediction is missing and that is not allowed.
    pub(crate) fn of(
        truth: &LabelSet,
        prediction: &LabelSet,
        args: &EvaluateArgs,
    ) -> Result<Self, Fault> {
        let asked = asked(truth.keyframes(), args)?;
        let pairing = pair(asked, prediction.keyframes(), args)?;
        match pairing.missing_fault(args) {
            Some(missing) if !args.allow_missing || pairing.pairs.is_empty() => Err(missing),
            _ if pairing.pairs.is_empty() => {
                let place = args.truth.display().to_string();
                Err(Fault::new("evaluate-keyframes", place, "keyframes", "none"))
            }
            _ => Ok(pairing),
        }
    }

    /// What is missing, if anything is.
    pub(crate) fn missing_fault(&self, args: &EvaluateArgs) -> Option<Fault> {
        let all = self.pairs.len() + self.missing.len();
        let names: Vec<String> = self.missing.iter().take(NAMED).map(name).collect();
        let more = if self.missing.len() > NAMED { ", …" } else { "" };
        let found = format!("{} missing: {}{more}", self.missing.len(), names.join(", "));
        let place = args.prediction.display().to_string();
        let expected = format!("a prediction for each of {all} keyframes");
        let fault = Fault::new("prediction-missing", place, expected, found);
        (!self.missing.is_empty()).then(|| match args.allow_missing {
            true => fault,
            false => fault.hint("score the others with --allow-missing"),
        })
    }
}

/// The keyframes of the scenes that are asked for.
fn asked<'a>(
    keyframes: &'a [KeyframeKey],
    args: &EvaluateArgs,
) -> Result<Vec<&'a KeyframeKey>, Fault> {
    let scenes: BTreeSet<&str> = keyframes.iter().map(|key| key.scene.as_str()).collect();
    if let Some(strange) = args.scenes.iter().find(|scene| !scenes.contains(scene.as_str())) {
        let place = args.truth.display().to_string();
        let known: Vec<&str> = scenes.into_iter().take(8).collect();
        let expected = format!("a scene of the truth, such as {}", known.join(", "));
        return Err(Fault::new("evaluate-scene", place, expected, format!("`{strange}`")));
    }
    let is_asked = |key: &&KeyframeKey| args.scenes.is_empty() || args.scenes.contains(&key.scene);
    Ok(keyframes.iter().filter(is_asked).collect())
}

/// By scene and token where both sides have scenes, else by token.
fn pair(
    truth: Vec<&KeyframeKey>,
    predictions: &[KeyframeKey],
    args: &EvaluateArgs,
) -> Result<Pairing, Fault> {
    let has_scenes = |keys: &mut dyn Iterator<Item = &KeyframeKey>| {
        keys.next().is_some_and(|key| !key.scene.is_empty())
    };
    let by_scene = has_scenes(&mut truth.iter().copied()) && has_scenes(&mut predictions.iter());
    let key = |key: &KeyframeKey| {
        (if by_scene { key.scene.clone() } else { String::new() }, key.token.clone())
    };
    let mut known: BTreeMap<_, &KeyframeKey> = BTreeMap::new();
    for prediction in predictions {
        if known.insert(key(prediction), prediction).is_some() {
            return Err(twice(&prediction.token, &args.prediction));
        }
    }
    let mut pairing = Pairing { unused: known.len(), ..Pairing::default() };
    let mut met = BTreeSet::new();
    for truth in truth {
        if !met.insert(key(truth)) {
            return Err(twice(&truth.token, &args.truth));
        }
        match known.get(&key(truth)) {
            Some(&prediction) => pairing.pairs.push((truth.clone(), prediction.clone())),
            None => pairing.missing.push(truth.clone()),
        }
    }
    pairing.unused -= pairing.pairs.len();
    Ok(pairing)
}

fn twice(token: &str, folder: &std::path::Path) -> Fault {
    let expected = "each token once, where one side's files name no scene";
    let found = format!("`{token}` twice");
    Fault::new("evaluate-token", folder.display().to_string(), expected, found)
}

fn name(key: &KeyframeKey) -> String {
    if key.scene.is_empty() { key.token.clone() } else { format!("{}/{}", key.scene, key.token) }
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

    fn paired(truth: &[(&str, &str)], predictions: &[(&str, &str)]) -> Result<Pairing, Fault> {
        pair(keys(truth).iter().collect(), &keys(predictions), &args(&[]))
    }

    #[test]
    fn a_submission_is_found_by_its_tokens() {
        let pairing =
            paired(&[("a", "1"), ("b", "2")], &[("", "2"), ("", "1"), ("", "3")]).unwrap();
        let expected =
            keys(&[("a", "1"), ("b", "2")]).into_iter().zip(keys(&[("", "1"), ("", "2")]));
        assert_eq!(pairing.pairs, expected.collect::<Vec<_>>());
        assert_eq!((pairing.missing.len(), pairing.unused), (0, 1));
    }

    #[test]
    fn frames_of_two_scenes_may_have_one_number() {
        let pairing = paired(&[("a", "1"), ("b", "1")], &[("b", "1")]).unwrap();
        assert_eq!(pairing.missing, keys(&[("a", "1")]));
        assert_eq!(pairing.pairs[0].0, pairing.pairs[0].1);
        let fault = paired(&[("a", "1"), ("b", "1")], &[("", "1")]).unwrap_err();
        assert!(fault.to_string().contains("`1` twice"), "{fault}");
    }

    #[test]
    fn what_is_missing_is_counted_and_named() {
        let truth: Vec<(&str, &str)> =
            vec![("a", "1"), ("a", "2"), ("a", "3"), ("a", "4"), ("a", "5")];
        let pairing = paired(&truth, &[("a", "3")]).unwrap();
        let text = pairing.missing_fault(&args(&[])).unwrap().to_string();
        assert!(text.contains("4 missing: a/1, a/2, a/4, …") && text.contains("of 5"), "{text}");
        assert!(text.contains("--allow-missing"), "{text}");
    }

    #[test]
    fn a_scene_that_is_not_there_is_refused() {
        let keys = keys(&[("a", "1"), ("b", "2")]);
        assert_eq!(asked(&keys, &args(&["--scenes", "b"])).unwrap(), [&keys[1]]);
        let fault = asked(&keys, &args(&["--scenes", "b,c"])).unwrap_err().to_string();
        assert!(fault.contains("`c`") && fault.contains("a, b"), "{fault}");
    }
}
