//! Pictures of labels, drawn without a display.
