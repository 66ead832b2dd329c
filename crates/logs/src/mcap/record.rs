//! A record's body, parsed.

use mcap::records::{Record, op};

/// What a body says, of the kinds that are read; any other is unknown.
///
/// The library reserves what a text declares, so that is compared with the body before.
///
/// # Errors
/// What was found, if it is not laid out as its kind is.
pub(super) fn parse(kind: u8, body: &[u8]) -> Result<Record<'_>, String> {
    match kind {
        0 => return Err("a record of kind 0".into()),
        op::SCHEMA | op::CHANNEL | op::MESSAGE | op::CHUNK | op::METADATA => {}
        opcode => return Ok(Record::Unknown { opcode, data: body.into() }),
    }
    texts_fit(kind, body)
        .ok_or_else(|| format!("a text beyond the end of a record of kind {kind}"))?;
    mcap::parse_record(kind, body).map_err(|error| error.to_string())
}

/// Whether the texts of a body end within it.
fn texts_fit(kind: u8, body: &[u8]) -> Option<()> {
    let mut rest = body;
    match kind {
        op::SCHEMA => {
            rest = rest.get(2..)?;
            text(&mut rest)?;
            text(&mut rest)?;
        }
        op::CHANNEL => {
            rest = rest.get(4..)?;
            text(&mut rest)?;
            text(&mut rest)?;
            pairs(&mut rest)?;
        }
        op::METADATA => {
            text(&mut rest)?;
            pairs(&mut rest)?;
        }
        op::CHUNK => {
            rest = rest.get(28..)?;
            text(&mut rest)?;
        }
        _ => {}
    }
    Some(())
}

/// Steps over a text, and gives it.
fn text<'a>(rest: &mut &'a [u8]) -> Option<&'a [u8]> {
    let (length, after) = rest.split_first_chunk()?;
    let (text, after) = after.split_at_checked(u32::from_le_bytes(*length) as usize)?;
    *rest = after;
    Some(text)
}

/// Steps over a list of two texts each.
fn pairs(rest: &mut &[u8]) -> Option<()> {
    let mut list = text(rest)?;
    while !list.is_empty() {
        text(&mut list)?;
        text(&mut list)?;
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text_of(bytes: &[u8]) -> Vec<u8> {
        [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
    }

    #[test]
    fn fault_34_no_text_is_believed_to_be_longer_than_its_record() {
        let (a, list) = (text_of(b"a"), text_of(&[text_of(b"key"), text_of(b"value")].concat()));
        let schema = [&[1, 0][..], &a, &a, &text_of(b"data")].concat();
        let channel = [&[1, 0, 1, 0][..], &a, &a, &list].concat();
        let metadata = [&a[..], &list].concat();
        let chunk = [&[0; 28][..], &a, &[0; 8]].concat();
        let sound = [
            (op::SCHEMA, schema),
            (op::CHANNEL, channel),
            (op::METADATA, metadata),
            (op::CHUNK, chunk),
        ];
        let mut refused = 0;
        for (kind, body) in sound {
            assert!(parse(kind, &body).is_ok(), "{kind}");
            for at in 0..body.len().saturating_sub(4) {
                let mut broken = body.clone();
                broken[at..at + 4].fill(0xff);
                let found = parse(kind, &broken).err();
                refused += usize::from(found.is_some_and(|found| found.contains("a text beyond")));
            }
        }
        assert!(refused > 40, "{refused}");
    }

    #[test]
    fn kind_0_is_none_and_others_are_left_alone() {
        assert!(parse(0, &[]).is_err());
        assert!(matches!(parse(op::HEADER, &[0xff; 9]), Ok(Record::Unknown { .. })));
    }
}
