//! The functions of memory that ufbx calls, under the names that it gives them
//! (`UFBX_EXTERNAL_MALLOC` in ufbx.c): the allocator of Rust, so that one place counts and bounds
//! all memory of a program.

#![expect(unsafe_code, reason = "C calls these functions by name and with raw pointers")]

use std::alloc::{Layout, alloc, dealloc, realloc};
use std::ffi::c_void;

/// The alignment of all that is allocated, as `malloc` gives it.
const ALIGN: usize = 2 * size_of::<usize>();

fn layout(size: usize) -> Option<Layout> {
    Layout::from_size_align(size.max(1), ALIGN).ok()
}

#[unsafe(no_mangle)]
extern "C" fn ufbx_malloc(size: usize) -> *mut c_void {
    // SAFETY: the layout is not empty.
    layout(size).map_or(std::ptr::null_mut(), |layout| unsafe { alloc(layout) }.cast())
}

// SAFETY: ufbx passes a pointer that `ufbx_malloc` or this function returned, with its size.
#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_realloc(old: *mut c_void, old_size: usize, size: usize) -> *mut c_void {
    let (Some(before), Some(_), false) = (layout(old_size), layout(size), old.is_null()) else {
        return if old.is_null() { ufbx_malloc(size) } else { std::ptr::null_mut() };
    };
    unsafe { realloc(old.cast(), before, size.max(1)) }.cast()
}

// SAFETY: as for `ufbx_realloc`.
#[unsafe(no_mangle)]
unsafe extern "C" fn ufbx_free(old: *mut c_void, size: usize) {
    if let (Some(layout), false) = (layout(size), old.is_null()) {
        unsafe { dealloc(old.cast(), layout) };
    }
}
