!> The elements of a deck as written, before sections decide which of them the mesh gets.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_element_drafts
  use amontons_kinds, only: DP
  use amontons_containers, only: integer_list_type, label_table_type
  implicit none
  private
  public :: element_draft_type, resize_draft, NOT_GIVEN

  real(DP), parameter :: NOT_GIVEN = -huge(1.0_DP)   !< spring constant or mass; or the properties of a user element

  !> All elements of the deck as written.
  type :: element_draft_type
    integer :: n = 0
    integer, allocatable :: label(:)             !< (n)
    integer, allocatable :: kind(:)              !< (n) KIND_..., 0: unsupported kind
    logical, allocatable :: is_in_plane(:)       !< (n) T2D2, T2D3, B21, B22: a truss or beam in the plane
    logical, allocatable :: is_rigid(:)          !< (n) R3D3, R3D4: its section comes from *RIGID BODY
    integer, allocatable :: card(:)              !< (n) its ELEMENT card
    integer, allocatable :: line(:)              !< (n) its line
    integer, allocatable :: first(:)             !< (n + 1) start of its nodes
    type(integer_list_type) :: nodes             !< node indices, 0: unknown node
    integer, allocatable :: material(:)          !< (n) index of the material, 0: no section
    real(DP), allocatable :: section_value(:)          !< (n) thickness, cross-section, spring constant, mass; or NOT_GIVEN
    integer, allocatable :: directions(:, :)     !< (2, n) of SPRING1, SPRING2
    integer, allocatable :: spring(:)            !< (n) index into model%springs, 0: none
    integer, allocatable :: section(:)           !< (n) index into the sections of shells and beams, 0: none
    integer, allocatable :: user_kind(:)         !< (n) index into the kinds of user elements, 0: no user element
    integer, allocatable :: user_properties(:)   !< (n) index into the properties of user elements, 0: none
    integer, allocatable :: n_layers(:)          !< (n) of a composite shell; 1: all others
    integer, allocatable :: section_card(:)      !< (n) the card that gives its section, 0: none
    integer, allocatable :: mesh_index(:)              !< (n) index in the mesh of its first layer, 0: dropped
    integer, allocatable :: node_first(:)        !< (n_cards) first row of a NODE card among those of all
    integer, allocatable :: node_last(:)         !< (n_cards) last row of a NODE card
    integer, allocatable :: node_at(:)           !< (rows of NODE cards) index of its node
    integer, allocatable :: element_first(:)     !< (n_cards) first element of an ELEMENT card
    integer, allocatable :: element_last(:)      !< (n_cards) last element of an ELEMENT card
    integer, allocatable :: face_places(:, :)    !< (N_NUMBERED_FACES, n) as mesh%face_places
    type(label_table_type) :: labels             !< label to index here
  end type element_draft_type

contains

  !> Gives all arrays of the elements the length n: the elements there are stay, new ones have the values of an element without
  !! section. The number of elements and their nodes stay as they are.
  subroutine resize_draft(draft, n)
    type(element_draft_type), intent(inout) :: draft
    integer, intent(in) :: n
    integer, allocatable :: directions(:, :)
    real(DP), allocatable :: section_value(:)
    associate (kept => min(n, draft%n))
      allocate (directions(2, n), source=0)
      allocate (section_value(n), source=1.0_DP)
      if (kept > 0) directions(:, :kept) = draft%directions(:, :kept)
      if (kept > 0) section_value(:kept) = draft%section_value(:kept)
      call resize_integers(draft%label, kept, n, 0)
      call resize_integers(draft%kind, kept, n, 0)
      call resize_integers(draft%card, kept, n, 0)
      call resize_integers(draft%line, kept, n, 0)
      call resize_integers(draft%first, kept + 1, n + 1, 1)
      call resize_integers(draft%material, kept, n, 0)
      call resize_integers(draft%spring, kept, n, 0)
      call resize_integers(draft%section, kept, n, 0)
      call resize_integers(draft%user_kind, kept, n, 0)
      call resize_integers(draft%user_properties, kept, n, 0)
      call resize_integers(draft%n_layers, kept, n, 1)
      call resize_integers(draft%section_card, kept, n, 0)
      call resize_logicals(draft%is_in_plane, kept, n)
      call resize_logicals(draft%is_rigid, kept, n)
    end associate
    call move_alloc(directions, draft%directions)
    call move_alloc(section_value, draft%section_value)
  end subroutine resize_draft


  !> Gives an array n values: the first that are kept, then a default.
  pure subroutine resize_integers(values, kept, n, default)
    integer, allocatable, intent(inout) :: values(:)   !< in: unallocated, or at least kept values
    integer, intent(in) :: kept, n, default
    integer, allocatable :: resized(:)
    allocate (resized(n), source=default)
    if (allocated(values)) resized(:kept) = values(:kept)
    call move_alloc(resized, values)
  end subroutine resize_integers


  !> The same for truth values; new ones are false.
  pure subroutine resize_logicals(values, kept, n)
    logical, allocatable, intent(inout) :: values(:)   !< in: unallocated, or at least kept values
    integer, intent(in) :: kept, n
    logical, allocatable :: resized(:)
    allocate (resized(n), source=.false.)
    if (allocated(values)) resized(:kept) = values(:kept)
    call move_alloc(resized, values)
  end subroutine resize_logicals

end module amontons_element_drafts
