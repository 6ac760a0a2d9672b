!> Nodal: values of integration points brought to the nodes, and the volumes that integration points stand for.
!! SPDX-License-Identifier: GPL-3.0-or-later
module amontons_nodal
  use amontons_kinds, only: DP
  use amontons_topology, only: element_kind, kind_type, FAMILY_AXISYMMETRIC, FAMILY_SPRING, KIND_C3D6, &
    MAX_NODES, MAX_POINTS, N_KINDS
  use amontons_mesh, only: mesh_type, element_nodes, is_out
  use amontons_shapes, only: extrapolation_matrix, quadrature, shape_functions
  use amontons_element, only: element_point_volumes
  implicit none
  private
  public :: average_at_nodes, point_volumes, point_places

  real(DP), parameter :: OUT = 0.5_DP * (1 + sqrt(5.0_DP / 3.0_DP))   !< weight of the nearer point if it were one of three [-]
  real(DP), parameter :: IN_TURN(6) = [OUT, 1 - OUT, OUT, 1 - OUT, OUT, 1 - OUT]
  integer, parameter :: N_TENSOR = 6            !< components of a symmetric tensor

contains

  !> Extrapolates values from the integration points of each element to its nodes and takes the mean at each node.
  !!
  !! All elements at a node weigh the same, whatever their size or material (as in CalculiX); bodies in contact do not
  !! mix, since they share no node. Springs and masses have no stress and do not count. A node without elements gets 0.
  !! Cost: linear.
  !!
  !! As CalculiX writes them, springs and gaps of two nodes count as elements without stress, and the points of C3D6 are brought to
  !! the nodes in turn, as far out as if they were those of a rule of three points.
  subroutine average_at_nodes(mesh, values, averages, is_calculix)
    type(mesh_type), intent(in) :: mesh
    real(DP), intent(in) :: values(:, :)        !< (n_components, n_points)
    real(DP), intent(out) :: averages(:, :)     !< (n_components, n_nodes) same unit
    logical, intent(in), optional :: is_calculix    !< default .false.
    real(DP) :: matrix(MAX_NODES, MAX_POINTS, N_KINDS)
    logical :: is_made(N_KINDS)
    integer :: n_elements_at(mesh%n_nodes)
    type(kind_type) :: entry
    integer :: e, a, p, n, n_points, kind, first, nodes(MAX_NODES)
    logical :: is_as_there
    is_as_there = .false.
    if (present(is_calculix)) is_as_there = is_calculix
    is_made = .false.
    averages = 0
    n_elements_at = 0
    do e = 1, mesh%n_elements
      if (is_out(mesh, e)) cycle
      kind = mesh%kind(e)
      entry = element_kind(kind)
      if (entry%family >= FAMILY_SPRING) then
        if (is_as_there .and. entry%n_nodes == 2) call count_spring(mesh, e, n_elements_at)
        cycle
      end if
      if (.not. is_made(kind)) call extrapolation_matrix(kind, matrix(:, :, kind), n, n_points)
      if (is_as_there .and. kind == KIND_C3D6) matrix(:6, :2, kind) = reshape([IN_TURN, 1 - IN_TURN], [6, 2])
      is_made(kind) = .true.
      call element_nodes(mesh, e, n, nodes)
      first = mesh%point_first(e)
      n_points = mesh%point_first(e + 1) - first
      n_elements_at(nodes(:n)) = n_elements_at(nodes(:n)) + 1
      if (size(values, 1) == N_TENSOR) then
        call add_tensors(matrix(:, :, kind), values(:, first:first + n_points - 1), nodes(:n), averages)
        cycle
      end if
      do a = 1, n
        do p = 1, n_points
          averages(:, nodes(a)) = averages(:, nodes(a)) + matrix(a, p, kind) * values(:, first + p - 1)
        end do
      end do
    end do
    do a = 1, mesh%n_nodes
      averages(:, a) = averages(:, a) / real(max(1, n_elements_at(a)), DP)
    end do
  end subroutine average_at_nodes


  !> A spring counts at its nodes.
  pure subroutine count_spring(mesh, e, n_elements_at)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                    !< element
    integer, intent(inout) :: n_elements_at(:)  !< (n_nodes)
    integer :: n, nodes(MAX_NODES)
    call element_nodes(mesh, e, n, nodes)
    n_elements_at(nodes(:n)) = n_elements_at(nodes(:n)) + 1
  end subroutine count_spring


  !> Extrapolates the tensors of one element and adds them at its nodes.
  pure subroutine add_tensors(matrix, values, nodes, averages)
    real(DP), intent(in) :: matrix(:, :)        !< (MAX_NODES, MAX_POINTS)
    real(DP), intent(in) :: values(:, :)        !< (6, n_points)
    integer, intent(in) :: nodes(:)
    real(DP), intent(inout) :: averages(:, :)   !< (6, n_nodes)
    real(DP) :: here(N_TENSOR)
    integer :: a, p
    do a = 1, size(nodes)
      here = averages(:N_TENSOR, nodes(a))
      do p = 1, size(values, 2)
        here = here + matrix(a, p) * values(:N_TENSOR, p)
      end do
      averages(:N_TENSOR, nodes(a)) = here
    end do
  end subroutine add_tensors


  !> The places of the integration points for given places of the nodes. Points of springs and masses are in the middle.
  subroutine point_places(mesh, x, places)
    type(mesh_type), intent(in) :: mesh
    real(DP), intent(in) :: x(:, :)                !< (3, n_nodes) [length]
    real(DP), intent(out) :: places(:, :)          !< (3, n_points) [length]
    real(DP) :: xi(3, MAX_POINTS), w(MAX_POINTS), shape(MAX_NODES), slope(3, MAX_NODES)
    integer :: e, p, n, n_rule, nodes(MAX_NODES)
    do e = 1, mesh%n_elements
      call element_nodes(mesh, e, n, nodes)
      associate (kind => element_kind(mesh%kind(e)))
        n_rule = 0
        if (kind%family <= FAMILY_AXISYMMETRIC) call quadrature(mesh%kind(e), n_rule, xi, w)
      end associate
      shape(:n) = 1 / real(n, DP)
      do p = 1, mesh%point_first(e + 1) - mesh%point_first(e)
        if (n_rule > 0) call shape_functions(mesh%kind(e), xi(:, p), shape, slope)
        places(:, mesh%point_first(e) + p - 1) = matmul(x(:, nodes(:n)), shape(:n))
      end do
    end do
  end subroutine point_places


  !> The reference volume that each integration point of an element stands for: weight times Jacobian.
  pure subroutine point_volumes(mesh, e, n, volumes)
    type(mesh_type), intent(in) :: mesh
    integer, intent(in) :: e                       !< element index
    integer, intent(out) :: n                      !< number of its points
    real(DP), intent(out) :: volumes(MAX_POINTS)   !< (MAX_POINTS) the first n are set, 0 past n [length^3]
    integer :: n_nodes, status, nodes(MAX_NODES)
    call element_nodes(mesh, e, n_nodes, nodes)
    call element_point_volumes(mesh%kind(e), mesh%coordinates(:, nodes(:n_nodes)), mesh%section(e), n, volumes, status)
  end subroutine point_volumes

end module amontons_nodal
