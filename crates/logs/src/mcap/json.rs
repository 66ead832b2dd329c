//! Foxglove's schemas as JSON: the same fields by name, bytes in base 64.

use occlabel_core::Timestamp;
use serde_json::Value;

use super::dispatch::{Decoded, Kind};
use super::messages::{
    Boxes, Cloud, Cube, Defect, Field, Header, Link, Optics, Picture, RawPose, frame_name,
    timestamp,
};
use super::protobuf::number_kind;

/// Decodes a message.
///
/// # Errors
/// If it is no JSON, or a list or bytes are none.
pub(super) fn decode(kind: Kind, data: &[u8]) -> Result<Decoded, Defect> {
    let message: Value = serde_json::from_slice(data)
        .map_err(|error| Defect::new("a message in JSON", error.to_string()))?;
    let message = &message;
    Ok(match kind {
        Kind::Cloud => Decoded::Cloud(cloud(message)?),
        Kind::Link => Decoded::Links(vec![link(message)]),
        Kind::Links => Decoded::Links(list(message, "transforms").iter().map(link).collect()),
        Kind::Optics => Decoded::Optics(optics(message)),
        Kind::Scene | Kind::Detections | Kind::Markers => Decoded::Boxes(boxes(message)),
        Kind::CompressedPicture => {
            Decoded::Picture(Picture { header: header(message), data: bytes(message, "data")? })
        }
        Kind::RawPicture => Decoded::Picture(Picture { header: header(message), data: Vec::new() }),
    })
}

fn cloud(message: &Value) -> Result<Cloud, Defect> {
    let pose_of = |value: &Value| pose(value, "position", "orientation");
    let (data, point_step) = (bytes(message, "data")?, integer(message, "point_stride") as usize);
    Ok(Cloud {
        header: header(message),
        pose: message.get("pose").map_or(RawPose::IDENTITY, pose_of),
        fields: list(message, "fields").iter().map(field).collect::<Result<_, _>>()?,
        rows: 1,
        width: data.len().checked_div(point_step).unwrap_or(0),
        row_step: data.len(),
        point_step,
        big_endian: false,
        data,
    })
}

fn field(value: &Value) -> Result<Field, Defect> {
    Ok(Field {
        name: text(value, "name"),
        offset: integer(value, "offset") as usize,
        kind: number_kind(integer(value, "type"))?,
    })
}

fn link(value: &Value) -> Link {
    Link {
        header: Header {
            time: time(&value["timestamp"]),
            frame: frame_name(&text(value, "parent_frame_id")),
        },
        child: frame_name(&text(value, "child_frame_id")),
        parent_from_child: pose(value, "translation", "rotation"),
    }
}

fn optics(value: &Value) -> Optics {
    let size = |key| u32::try_from(integer(value, key)).unwrap_or(0);
    Optics {
        header: header(value),
        width: size("width"),
        height: size("height"),
        model: text(value, "distortion_model"),
        distortion: list(value, "D").iter().map(number).collect(),
        matrix: list(value, "K").iter().map(number).collect(),
    }
}

fn boxes(value: &Value) -> Boxes {
    const ALL: i64 = 1;
    let deletions = list(value, "deletions").iter();
    let all = deletions.filter(|deletion| integer(deletion, "type") == ALL);
    Boxes {
        cubes: list(value, "entities").iter().flat_map(cubes).collect(),
        cleared: all.map(|deletion| time(&deletion["timestamp"])).collect(),
    }
}

/// The cubes of an entity; of several, each is a track of its own.
fn cubes(entity: &Value) -> Vec<Cube> {
    let id = text(entity, "id");
    let pairs = list(entity, "metadata").iter();
    let category = pairs.rev().find(|pair| pair["key"] == "category");
    let category = category.map(|pair| text(pair, "value")).unwrap_or_default();
    let cubes = list(entity, "cubes");
    let cube = |(place, cube): (usize, &Value)| Cube {
        header: header(entity),
        track: if cubes.len() > 1 { format!("{id}/{place}") } else { id.clone() },
        category: category.clone(),
        pose: pose(&cube["pose"], "position", "orientation"),
        size_m: axes(&cube["size"], ["x", "y", "z"]),
    };
    cubes.iter().enumerate().map(cube).collect()
}

fn header(value: &Value) -> Header {
    Header { time: time(&value["timestamp"]), frame: frame_name(&text(value, "frame_id")) }
}

fn time(value: &Value) -> Timestamp {
    let nanos = value.get("nsec").or_else(|| value.get("nanosec"));
    timestamp(integer(value, "sec"), nanos.and_then(Value::as_i64).unwrap_or(0))
}

fn pose(value: &Value, translation: &str, rotation: &str) -> RawPose {
    RawPose {
        translation: axes(&value[translation], ["x", "y", "z"]),
        rotation: axes(&value[rotation], ["x", "y", "z", "w"]),
    }
}

fn axes<const N: usize>(value: &Value, names: [&str; N]) -> [f64; N] {
    names.map(|name| number(&value[name]))
}

/// A number; what JSON has none for is written as a text, such as `"Infinity"`.
fn number(value: &Value) -> f64 {
    let written = || value.as_str().and_then(|text| text.parse().ok());
    value.as_f64().or_else(written).unwrap_or(f64::NAN)
}

fn integer(value: &Value, key: &str) -> i64 {
    value[key].as_i64().unwrap_or(0)
}

fn text(value: &Value, key: &str) -> String {
    value[key].as_str().unwrap_or_default().to_owned()
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value[key].as_array().map_or(&[], Vec::as_slice)
}

fn bytes(value: &Value, key: &str) -> Result<Vec<u8>, Defect> {
    let text = value[key].as_str().unwrap_or_default();
    let digits = text.trim_end_matches('=').bytes();
    let (mut bytes, mut bits, mut count) = (Vec::with_capacity(text.len() / 4 * 3), 0_u32, 0);
    for digit in digits {
        let Some(six) = six_bits(digit) else {
            return Err(Defect::new("bytes in base 64", format!("`{}`", char::from(digit))));
        };
        (bits, count) = (bits << 6 | six, count + 6);
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
        }
    }
    Ok(bytes)
}

/// RFC 4648 section 4.
fn six_bits(digit: u8) -> Option<u32> {
    let value = match digit {
        b'A'..=b'Z' => digit - b'A',
        b'a'..=b'z' => digit - b'a' + 26,
        b'0'..=b'9' => digit - b'0' + 52,
        b'+' => 62,
        b'/' => 63,
        _ => return None,
    };
    Some(value.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_json_has_not_are_read_as_texts() {
        let axes = |x: Value| axes(&serde_json::json!({ "x": x }), ["x"])[0];
        assert_eq!(axes("Infinity".into()), f64::INFINITY);
        assert_eq!(axes("-Infinity".into()), f64::NEG_INFINITY);
        assert!(axes("NaN".into()).is_nan() && axes(Value::Null).is_nan());
        assert_eq!(axes(1.5.into()), 1.5);
    }

    #[test]
    fn base_64_is_as_rfc_4648_shows() {
        let decoded = |text: &str| bytes(&serde_json::json!({ "data": text }), "data");
        for (text, expected) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg==", "foob")]
        {
            assert_eq!(decoded(text).unwrap(), expected.as_bytes());
        }
        assert_eq!(decoded("+/8=").unwrap(), [0xfb, 0xff]);
        assert!(decoded("Zm9?").is_err());
    }
}
