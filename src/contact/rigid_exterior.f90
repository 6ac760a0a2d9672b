!> Rigid bodies on the exterior: which nodes belong to one, which of them supports drive, which sides of rigid elements face.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_rigid_exterior
  use amontons_kinds, only: DP
  use amontons_text, only: to_text
  use amontons_element_kinds, only: KIND_R2D2, KIND_RAX2
  use amontons_model, only: model_type, free_unknowns
  use amontons_mpc_data, only: MPC_RIGID_BODY
  implicit none
  private
  public :: rigid_bodies_type, collect_rigid_bodies, is_pair_driven, is_one_body, unpaired_edges_warning
  public :: compare_sheets, SHEETS_FACE, SHEETS_BEHIND, SHEETS_UNDECIDED

  integer, parameter :: SHEETS_FACE = 1            !< one face lies before the other, and neither behind
  integer, parameter :: SHEETS_BEHIND = 2          !< a face lies behind the other: the far sides of two sheets
  integer, parameter :: SHEETS_UNDECIDED = 3       !< in one plane, or each reaches through the plane of the other

  !> The rigid body of each node.
  type :: rigid_bodies_type
    integer, allocatable :: reference(:)           !< (n_nodes) its reference node; 0: the node is of none
    logical, allocatable :: is_whole(:)            !< (n_nodes) no motion of its own is left, as by a coupling of some directions
    logical, allocatable :: is_driven(:)           !< (n_nodes) and supports prescribe the motion of the reference node in each step
  end type rigid_bodies_type

contains

  !> The rigid bodies of the nodes, and those that supports drive in each step.
  subroutine collect_rigid_bodies(model, bodies)
    type(model_type), intent(in) :: model
    type(rigid_bodies_type), intent(out) :: bodies
    logical, allocatable :: is_free(:, :)
    integer :: i, k, n_dofs, first_rotation
    allocate (bodies%reference(model%mesh%n_nodes), source=0)
    allocate (bodies%is_driven(model%mesh%n_nodes), bodies%is_whole(model%mesh%n_nodes), source=.false.)
    if (.not. allocated(model%nonlinear_mpcs)) return
    n_dofs = merge(2, 3, all(model%mesh%is_unstiffened(3, :) .or. .not. model%mesh%has_elements))   ! plane models: 2
    first_rotation = merge(3, 1, n_dofs == 2)
    bodies%is_driven = .true.
    do k = 1, size(model%steps)
      is_free = free_unknowns(model, k)
      do i = 1, size(model%nonlinear_mpcs)
        associate (body => model%nonlinear_mpcs(i))
          if (body%kind /= MPC_RIGID_BODY) cycle
          bodies%reference(body%node) = body%reference
          bodies%is_whole(body%node) = all(body%is_bound(:n_dofs)) .and. body%expansion == 0
          bodies%is_driven(body%node) = bodies%is_driven(body%node) .and. .not. any(is_free(:n_dofs, body%reference))
          if (body%rotation > 0) bodies%is_driven(body%node) = bodies%is_driven(body%node) .and. &
            .not. any(is_free(first_rotation:, body%rotation))
        end associate
      end do
    end do
    bodies%is_driven = bodies%is_driven .and. bodies%is_whole
  end subroutine collect_rigid_bodies


  !> Whether two nodes cannot move relative to each other but as prescribed: they belong to one rigid body or to two driven ones.
  pure logical function is_pair_driven(bodies, nodes)
    type(rigid_bodies_type), intent(in) :: bodies
    integer, intent(in) :: nodes(2)
    is_pair_driven = all(bodies%is_driven(nodes)) .or. is_one_body(bodies, nodes)
  end function is_pair_driven


  !> Whether two nodes belong to one rigid body.
  pure logical function is_one_body(bodies, nodes)
    type(rigid_bodies_type), intent(in) :: bodies
    integer, intent(in) :: nodes(2)
    is_one_body = all(bodies%is_whole(nodes)) .and. bodies%reference(nodes(1)) == bodies%reference(nodes(2))
  end function is_one_body


  !> How two opposing faces without depth lie to each other, by the sides of the mean plane of the one on which the corners of the
  !! other lie.
  pure integer function compare_sheets(corners, others, normals, tolerance) result(order)
    real(DP), intent(in) :: corners(:, :)          !< (3, :) of the first face [length]
    real(DP), intent(in) :: others(:, :)           !< (3, :) of the second one [length]
    real(DP), intent(in) :: normals(3, 2)          !< of both
    real(DP), intent(in) :: tolerance              !< within it a corner lies in a plane [length]
    real(DP) :: low(2), high(2)
    call measure(corners, others, normals(:, 1), low(1), high(1))
    call measure(others, corners, normals(:, 2), low(2), high(2))
    if (any(high <= tolerance .and. low < -tolerance)) then
      order = SHEETS_BEHIND
    else if (any(low >= -tolerance .and. high > tolerance)) then
      order = SHEETS_FACE
    else
      order = SHEETS_UNDECIDED
    end if

  contains

    !> The least and the largest height of points above the mean plane of a face [length].
    pure subroutine measure(face, points, normal, low, high)
      real(DP), intent(in) :: face(:, :), points(:, :), normal(3)
      real(DP), intent(out) :: low, high
      real(DP) :: height(size(points, 2))
      height = matmul(normal, points) - dot_product(normal, sum(face, dim=2)) / real(size(face, 2), DP)
      low = minval(height)
      high = maxval(height)
    end subroutine measure

  end function compare_sheets


  !> The warning of general contact about rigid edges of no pair, which bound no body and are not on the exterior; '': none.
  function unpaired_edges_warning(model) result(warning)
    type(model_type), intent(in) :: model
    character(:), allocatable :: warning
    logical :: is_found(model%mesh%n_elements)
    integer :: e, p
    is_found = .false.
    do p = 1, size(model%pairs)
      call mark_elements(model%pairs(p)%slave)
      call mark_elements(model%pairs(p)%master)
    end do
    warning = ''
    e = findloc((model%mesh%kind == KIND_R2D2 .or. model%mesh%kind == KIND_RAX2) .and. .not. is_found, .true., dim=1)
    if (e == 0) return
    warning = 'General contact does not find rigid edges (R2D2, RAX2), as element ' // to_text(model%mesh%element_label(e)) // &
      ': other bodies pass through them. If they can touch, name their side (SPOS or SNEG) in a *CONTACT PAIR.'

  contains

    !> The elements of a surface.
    subroutine mark_elements(surface)
      integer, intent(in) :: surface               !< index
      if (allocated(model%surfaces(surface)%element)) is_found(model%surfaces(surface)%element) = .true.
    end subroutine mark_elements

  end function unpaired_edges_warning

end module amontons_rigid_exterior
