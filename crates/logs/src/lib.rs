//! Readers: logged drives to scenes.
