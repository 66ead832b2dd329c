//! What a folder of files tells where the settings say `"auto"`.

use std::path::Path;

use occlabel_core::{Fault, McapSettings};

use super::container::{Container, Message};
use super::dispatch::{Decoded, decode};
use super::layout::{AUTO, FrameRoles, lidar_names};
use super::options::{Purpose, purpose};
use super::recording::{CloudHead, Recording};
use crate::notes::Notes;

/// What one file tells.
pub(super) struct Told {
    /// Names.
    pub(super) lidars: Vec<String>,
    /// `None` if its frames leave it open.
    pub(super) roles: Option<FrameRoles>,
}

/// Reads a file's transforms, and the first cloud of each topic that can be read.
///
/// # Errors
/// If the file cannot be read, or none of its clouds.
pub(super) fn resolve(root: &Path, file: &str, settings: &McapSettings) -> Result<Told, Fault> {
    let mut container = Container::open(root, file, settings.max_record_bytes)?;
    let (contents, cut) = container.contents();
    let reads = |wanted| move |channel: &_| purpose(settings, channel) == Some(wanted);
    let (mut recording, mut refused) = (Recording::new(file, settings), None);
    let takes = |message: &Message| match decode(message, false) {
        Ok(Some(Decoded::Cloud(cloud))) => {
            recording.clouds.push(CloudHead::new(message, cloud));
            true
        }
        Ok(_) => true,
        Err(defect) => {
            refused.get_or_insert_with(|| recording.fault("mcap-message", message, defect));
            false
        }
    };
    let broken = container.first_of_each(&contents, reads(Purpose::Sweeps), takes).err();
    [&cut, &broken].into_iter().try_for_each(refuse_unread)?;
    if recording.clouds.is_empty() {
        return Err(refused.or(broken).or(cut).unwrap_or_else(|| no_clouds(file)));
    }
    if settings.world_frame == AUTO || settings.ego_frame == AUTO {
        // What is broken or refused here is told of when the scene is read.
        let each = |message: _| recording.take_links(&message, &mut Notes::default());
        let visited = container.visit(&contents, reads(Purpose::Transforms), each);
        refuse_unread(&visited.err())?;
        recording.frames.finish();
    }
    let lidars = lidar_names(&recording.clouds, settings).into_values().collect();
    Ok(Told { lidars, roles: FrameRoles::find(&recording, settings).ok() })
}

/// What a disk does not give may be what tells: a file that is broken tells the same each time.
fn refuse_unread(fault: &Option<Fault>) -> Result<(), Fault> {
    match fault {
        Some(fault) if fault.rule == "unreadable-file" => Err(fault.clone()),
        _ => Ok(()),
    }
}

fn no_clouds(file: &str) -> Fault {
    let fault = Fault::new("mcap-clouds", file, "messages of point clouds", "none");
    fault.hint("`reader.mcap.lidars` limits them to certain topics")
}
