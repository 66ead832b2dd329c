//! The columns of v2's components, named as in the format's public component definitions.

use super::parquet_table::Kind;

/// A column.
type Column = (&'static str, Kind);

const SCENE: Column = ("key.segment_context_name", Kind::Text);
const TIME: Column = ("key.frame_timestamp_micros", Kind::Long);
const LASER: Column = ("key.laser_name", Kind::Byte);
const CAMERA: Column = ("key.camera_name", Kind::Byte);

/// All components that are written, with their columns.
pub(super) const COMPONENTS: [(&str, &[Column]); 8] = [
    ("lidar", LIDAR),
    ("lidar_pose", LIDAR_POSE),
    ("lidar_segmentation", LIDAR_SEGMENTATION),
    ("lidar_calibration", LIDAR_CALIBRATION),
    ("lidar_box", LIDAR_BOX),
    ("camera_calibration", CAMERA_CALIBRATION),
    ("camera_image", CAMERA_IMAGE),
    (super::components::VEHICLE_POSE, VEHICLE_POSE),
];

const LIDAR: &[Column] = &[
    SCENE,
    TIME,
    LASER,
    ("[LiDARComponent].range_image_return1.values", Kind::Floats),
    ("[LiDARComponent].range_image_return1.shape", Kind::Integers),
    ("[LiDARComponent].range_image_return2.values", Kind::Floats),
    ("[LiDARComponent].range_image_return2.shape", Kind::Integers),
];
const LIDAR_POSE: &[Column] = &[
    SCENE,
    TIME,
    LASER,
    ("[LiDARPoseComponent].range_image_return1.values", Kind::Floats),
    ("[LiDARPoseComponent].range_image_return1.shape", Kind::Integers),
];
const LIDAR_SEGMENTATION: &[Column] = &[
    SCENE,
    TIME,
    LASER,
    ("[LiDARSegmentationLabelComponent].range_image_return1.values", Kind::Integers),
    ("[LiDARSegmentationLabelComponent].range_image_return1.shape", Kind::Integers),
    ("[LiDARSegmentationLabelComponent].range_image_return2.values", Kind::Integers),
    ("[LiDARSegmentationLabelComponent].range_image_return2.shape", Kind::Integers),
];
const LIDAR_CALIBRATION: &[Column] = &[
    SCENE,
    LASER,
    ("[LiDARCalibrationComponent].extrinsic.transform", Kind::Reals),
    ("[LiDARCalibrationComponent].beam_inclination.min", Kind::Real),
    ("[LiDARCalibrationComponent].beam_inclination.max", Kind::Real),
    ("[LiDARCalibrationComponent].beam_inclination.values", Kind::Reals),
];
const LIDAR_BOX: &[Column] = &[
    SCENE,
    TIME,
    ("key.laser_object_id", Kind::Text),
    ("[LiDARBoxComponent].box.center.x", Kind::Real),
    ("[LiDARBoxComponent].box.center.y", Kind::Real),
    ("[LiDARBoxComponent].box.center.z", Kind::Real),
    ("[LiDARBoxComponent].box.size.x", Kind::Real),
    ("[LiDARBoxComponent].box.size.y", Kind::Real),
    ("[LiDARBoxComponent].box.size.z", Kind::Real),
    ("[LiDARBoxComponent].box.heading", Kind::Real),
    ("[LiDARBoxComponent].type", Kind::Byte),
];
const CAMERA_CALIBRATION: &[Column] = &[
    SCENE,
    CAMERA,
    ("[CameraCalibrationComponent].intrinsic.f_u", Kind::Real),
    ("[CameraCalibrationComponent].intrinsic.f_v", Kind::Real),
    ("[CameraCalibrationComponent].intrinsic.c_u", Kind::Real),
    ("[CameraCalibrationComponent].intrinsic.c_v", Kind::Real),
    ("[CameraCalibrationComponent].intrinsic.k1", Kind::Real),
    ("[CameraCalibrationComponent].intrinsic.k2", Kind::Real),
    ("[CameraCalibrationComponent].intrinsic.p1", Kind::Real),
    ("[CameraCalibrationComponent].intrinsic.p2", Kind::Real),
    ("[CameraCalibrationComponent].intrinsic.k3", Kind::Real),
    ("[CameraCalibrationComponent].extrinsic.transform", Kind::Reals),
    ("[CameraCalibrationComponent].width", Kind::Integer),
    ("[CameraCalibrationComponent].height", Kind::Integer),
    ("[CameraCalibrationComponent].rolling_shutter_direction", Kind::Byte),
];
const CAMERA_IMAGE: &[Column] = &[
    SCENE,
    TIME,
    CAMERA,
    ("[CameraImageComponent].pose.transform", Kind::Reals),
    ("[CameraImageComponent].pose_timestamp", Kind::Real),
    ("[CameraImageComponent].rolling_shutter_params.shutter", Kind::Real),
    ("[CameraImageComponent].rolling_shutter_params.camera_trigger_time", Kind::Real),
    ("[CameraImageComponent].rolling_shutter_params.camera_readout_done_time", Kind::Real),
];
const VEHICLE_POSE: &[Column] =
    &[SCENE, TIME, ("[VehiclePoseComponent].world_from_vehicle.transform", Kind::Reals)];
