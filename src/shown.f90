!> Shown: analytic surfaces as points and cells for the eye, which move with the nodes that carry them.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! They are in the grid of the result file only, after the nodes and elements of the mesh; nothing is computed with them.
module amontons_shown
  use amontons_kinds, only: DP, PI
  use amontons_topology, only: element_kind, kind_type, KIND_T3D2, KIND_CPS4
  use amontons_profiles, only: profile_type, point_of, PROFILE_FLAT, PROFILE_DRAWN, PROFILE_TURNED
  use amontons_analytic, only: carrier_weights
  use amontons_model, only: model_type
  implicit none
  private
  public :: shown_type, draw_profiles, displacement_of

  real(DP), parameter :: STEP = PI / 36.0_DP   !< largest angle of a cell on an arc [rad]
  real(DP), parameter :: MARGIN = 0.1_DP       !< a surface that is drawn out goes this far beyond the mesh, over its size [-]

  !> Points and cells.
  type :: shown_type
    integer :: n_points = 0
    integer :: n_cells = 0
    real(DP), allocatable :: points(:, :)      !< (3, n_points) undeformed [length]
    integer, allocatable :: carriers(:, :)     !< (4, n_points) nodes; 0: none
    real(DP), allocatable :: weights(:, :)     !< (4, n_points) [-]
    integer, allocatable :: nodes(:)           !< points of all cells, from 1
    integer, allocatable :: last(:)            !< (n_cells) end of each cell in nodes
    integer, allocatable :: vtk_type(:)        !< (n_cells)
  end type shown_type

contains

  !> All analytic surfaces of a model. Before: their carriers are known.
  subroutine draw_profiles(model, shown)
    type(model_type), intent(in) :: model
    type(shown_type), intent(out) :: shown
    integer :: s, k
    allocate (shown%points(3, 0), shown%carriers(4, 0), shown%weights(4, 0), shown%nodes(0), shown%last(0), shown%vtk_type(0))
    if (.not. allocated(model%surfaces)) return
    do s = 1, size(model%surfaces)
      if (.not. allocated(model%surfaces(s)%profile)) cycle
      do k = 1, model%surfaces(s)%profile%n
        call draw_piece(model, model%surfaces(s)%profile, k, shown)
      end do
    end do
  end subroutine draw_profiles


  !> One piece: points along it and across, cells between them.
  subroutine draw_piece(model, profile, k, shown)
    type(model_type), intent(in) :: model
    type(profile_type), intent(in) :: profile
    integer, intent(in) :: k
    type(shown_type), intent(inout) :: shown
    real(DP) :: X(3), p(2), normal(2), at(2)
    integer :: n_along, n_across, i, j, first, corner
    n_along = 1
    if (abs(profile%bend(k)) > 0.0_DP) n_along = ceiling(profile%extent(k) / (abs(profile%bend(k)) * STEP))
    n_across = merge(0, 1, profile%kind == PROFILE_FLAT)
    if (profile%kind == PROFILE_TURNED) n_across = nint(2.0_DP * PI / STEP)
    at = reach_across(model, profile)
    first = shown%n_points
    do j = 0, n_across
      do i = 0, n_along
        call point_of(profile, k, [real(i, DP) / real(n_along, DP), at(1) + (at(2) - at(1)) * real(j, DP) / &
          real(max(n_across, 1), DP)], X, p, normal)
        call add_point(profile, X, shown)
      end do
    end do
    do j = 1, max(n_across, 1)
      do i = 1, n_along
        corner = first + (j - 1) * (n_along + 1) + i
        if (n_across == 0) call add_cell([corner, corner + 1], shown)
        if (n_across > 0) call add_cell([corner, corner + 1, corner + n_along + 2, corner + n_along + 1], shown)
      end do
    end do
  end subroutine draw_piece


  !> From where to where a surface is shown across its profile: the mesh and a margin, or once round.
  pure function reach_across(model, profile) result(at)
    type(model_type), intent(in) :: model
    type(profile_type), intent(in) :: profile
    real(DP) :: at(2), along(model%mesh%n_nodes)
    at = 0.0_DP
    if (profile%kind == PROFILE_TURNED) at = [0.0_DP, 2.0_DP * PI]
    if (profile%kind /= PROFILE_DRAWN) return
    along = matmul(profile%axes(:, 3), model%mesh%coordinates - spread(profile%origin, 2, model%mesh%n_nodes))
    at = [minval(along, mask=model%mesh%has_elements), maxval(along, mask=model%mesh%has_elements)]
    at = at + MARGIN * (at(2) - at(1)) * [-1.0_DP, 1.0_DP]
  end function reach_across


  !> One more point.
  pure subroutine add_point(profile, X, shown)
    type(profile_type), intent(in) :: profile
    real(DP), intent(in) :: X(3)               !< [length]
    type(shown_type), intent(inout) :: shown
    integer :: n
    n = shown%n_points + 1
    shown%n_points = n
    shown%points = reshape([shown%points, X], [3, n])
    shown%carriers = reshape([shown%carriers, profile%carriers], [4, n])
    shown%weights = reshape([shown%weights, carrier_weights(profile, X)], [4, n])
  end subroutine add_point


  !> One more cell: a line or a square.
  pure subroutine add_cell(corners, shown)
    integer, intent(in) :: corners(:)
    type(shown_type), intent(inout) :: shown
    type(kind_type) :: entry
    entry = element_kind(merge(KIND_T3D2, KIND_CPS4, size(corners) == 2))
    shown%nodes = [shown%nodes, corners]
    shown%last = [shown%last, size(shown%nodes)]
    shown%vtk_type = [shown%vtk_type, entry%vtk_type]
    shown%n_cells = shown%n_cells + 1
  end subroutine add_cell


  !> The displacements of the points.
  pure function displacement_of(shown, u) result(moved)
    type(shown_type), intent(in) :: shown
    real(DP), intent(in) :: u(:, :)            !< (3, n_nodes) [length]
    real(DP) :: moved(3, shown%n_points)
    integer :: i, k
    moved = 0.0_DP
    do i = 1, shown%n_points
      do k = 1, 4
        if (shown%carriers(k, i) > 0) moved(:, i) = moved(:, i) + shown%weights(k, i) * u(:, shown%carriers(k, i))
      end do
    end do
  end function displacement_of

end module amontons_shown
