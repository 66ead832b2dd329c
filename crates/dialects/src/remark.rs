//! What a map between classes loses, in words.

use std::fmt;

use serde::Serialize;

use crate::ClassTable;
use crate::class_map::Reason;

/// Something that a map between classes loses or changes.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Remark {
    /// What happens.
    pub kind: RemarkKind,
    /// The classes that it happens to.
    pub classes: Vec<String>,
    /// What they become; `None` for no label.
    pub become_class: Option<String>,
    /// Those of the classes that would not come back as themselves.
    pub lost: Vec<String>,
}

/// What happens to classes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum RemarkKind {
    /// Several become one.
    Merged,
    /// One is taken as another that means something else.
    TakenAs,
    /// They become the class for the rest.
    Rest,
    /// They become no label.
    Dropped,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let classes = self.classes.join(", ");
        let becomes = self.become_class.as_deref().unwrap_or("no label");
        let (is, has) = if self.classes.len() == 1 { ("is", "has") } else { ("are", "have") };
        match self.kind {
            RemarkKind::Merged => {
                write!(f, "{classes} become {becomes}: not told apart afterwards")
            }
            RemarkKind::TakenAs => write!(f, "{classes} {is} taken as {becomes}"),
            RemarkKind::Rest => write!(f, "{classes} {has} no class there: {becomes}"),
            RemarkKind::Dropped => {
                write!(
                    f,
                    "{classes} {has} no class there, nor is there one for the rest: {becomes}"
                )
            }
        }
    }
}

/// Classes that become the same for the same kind of reason.
struct Group {
    becomes: u8,
    /// [`Reason::Rest`] or [`Reason::Nothing`], or else that they became classes by their meaning.
    reason: Option<Reason>,
    classes: Vec<usize>,
}

/// The remarks on what each class becomes; `survive` says which come back as themselves.
pub(crate) fn remarks(
    from: &ClassTable,
    to: &ClassTable,
    pairs: &[(u8, Reason)],
    survive: &[bool],
) -> Vec<Remark> {
    let remark = |group: &Group| {
        let name = |class: &usize| from.list[*class].name.clone();
        let lost = group.classes.iter().filter(|class| !survive[**class]);
        Some(Remark {
            kind: kind(group, pairs)?,
            classes: group.classes.iter().map(name).collect(),
            become_class: name_of(to, group.becomes),
            lost: lost.map(name).collect(),
        })
    };
    let mut remarks: Vec<_> = groups(pairs).iter().filter_map(remark).collect();
    remarks.sort_by_key(|remark| remark.kind);
    remarks
}

fn groups(pairs: &[(u8, Reason)]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (class, (becomes, reason)) in pairs.iter().enumerate() {
        let reason = Some(*reason).filter(|r| matches!(r, Reason::Rest | Reason::Nothing));
        let is_same = |group: &&mut Group| (group.becomes, group.reason) == (*becomes, reason);
        match groups.iter_mut().find(is_same) {
            Some(group) => group.classes.push(class),
            None => groups.push(Group { becomes: *becomes, reason, classes: vec![class] }),
        }
    }
    groups
}

/// What happens to classes that become the same; `None` if they mean the same too.
fn kind(group: &Group, pairs: &[(u8, Reason)]) -> Option<RemarkKind> {
    match group.classes.as_slice() {
        _ if group.reason == Some(Reason::Nothing) => Some(RemarkKind::Dropped),
        _ if group.reason == Some(Reason::Rest) => Some(RemarkKind::Rest),
        [class] if pairs[*class].1 == Reason::Same => None,
        [_] => Some(RemarkKind::TakenAs),
        _ => Some(RemarkKind::Merged),
    }
}

fn name_of(table: &ClassTable, index: u8) -> Option<String> {
    match table.list.get(usize::from(index)) {
        Some(class) => Some(class.name.clone()),
        None if index == table.free_index() => Some("free".to_owned()),
        None => None,
    }
}
