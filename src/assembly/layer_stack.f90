!> The bending of a stack of layers of CSS6, as each of its layers needs it.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The bubble of a thin triangle turns the fibre of all layers at once, and bends them all: its stiffness is none of a layer alone.
!! Theory: doc/theory/elements.md, section "Thin triangles".
module amontons_layer_stack
  use amontons_kinds, only: DP
  use amontons_element_integration_points, only: integration_points_type
  use amontons_element_kinds, only: KIND_CSS6
  use amontons_logarithmic_strain, only: voigt_transformation
  use amontons_model, only: model_type, material_in_step
  use amontons_state, only: state_type
  use amontons_structural_data, only: n_section_layers
  use amontons_tensor, only: cross_product, invert
  use amontons_zero_stress_condition, only: evaluate_initial_tangent, CONDITION_NONE
  implicit none
  private
  public :: is_stacked_triangle, load_stack_bending

  integer, parameter :: FACE_PARTS(3) = [1, 2, 4], NORMAL_PARTS(3) = [3, 5, 6]   !< entries of a Voigt vector

contains

  !> Whether an element is one of several layers of a triangle.
  pure logical function is_stacked_triangle(model, e)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                       !< element
    is_stacked_triangle = model%mesh%kind(e) == KIND_CSS6 .and. allocated(model%mesh%is_shell)
    if (is_stacked_triangle) is_stacked_triangle = model%structure%section(e) > 0 .and. .not. model%mesh%is_shell(e)
  end function is_stacked_triangle


  !> Sets the stiffness of the bubble for a layer: its share, by its thickness, of the bending energy of the stack at rest, about
  !! the neutral surface, with all layers in plane stress.
  pure subroutine load_stack_bending(model, state, e, is_nlgeom, points)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    integer, intent(in) :: e                       !< element, a stacked triangle
    logical, intent(in) :: is_nlgeom
    type(integration_points_type), intent(inout) :: points     !< out: stack_bending
    real(DP), parameter :: SLOPES(2, 3) = reshape([real(DP) :: 3, 3, -3, 0, 0, -3], [2, 3])   ! of 4/3 times the bubble
    real(DP) :: X(3, 6), local(3, 3), dual(2, 2), area, Q(3, 3), moments(3, 3, 3), D(3, 3), z, thickness, own, B(3, 2)
    integer :: first, n, l, p, i
    first = e - model%mesh%layer(e) + 1
    n = n_section_layers(model%structure%sections(model%structure%section(e)))
    X = solid_coordinates(model, first)
    X(:, 4:) = coordinates_above(model, first + n - 1)
    call find_face(0.5_DP * (X(:, :3) + X(:, 4:)), local, dual, area)
    moments = 0
    own = 0
    z = 0                                          ! from the bottom
    do l = 1, n
      X = solid_coordinates(model, first + l - 1)
      thickness = dot_product(sum(X(:, 4:) - X(:, :3), 2), local(:, 3)) / 3
      if (first + l - 1 == e) own = thickness
      call evaluate_plane_stress(model, state, first + l - 1, is_nlgeom, local, Q)
      do i = 1, 3
        moments(:, :, i) = moments(:, :, i) + Q * ((z + thickness)**i - z**i) / real(i, DP)
      end do
      z = z + thickness
    end do
    points%stack_bending = 0
    call bend_about_neutral_surface(moments, D)
    if (.not. (D(1, 1) > 0 .and. D(2, 2) > 0 .and. D(3, 3) > 0 .and. own > 0)) return
    D = D * (2 / z)**2                             ! strains of one at both faces
    do p = 1, 3
      do i = 1, 2
        associate (slope => matmul(transpose(dual), SLOPES(:, p)), turn => dual(i, :))
          B(:, i) = [slope(1) * turn(1), slope(2) * turn(2), slope(1) * turn(2) + slope(2) * turn(1)]
        end associate
      end do
      points%stack_bending = points%stack_bending + (area / 3 * z / own) * matmul(transpose(B), matmul(D, B))
    end do
  end subroutine load_stack_bending


  !> Coordinates of the nodes of a solid.
  pure function solid_coordinates(model, e) result(X)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                       !< CSS6
    real(DP) :: X(3, 6)                            !< [length]
    X = model%mesh%coordinates(:, model%mesh%nodes(model%mesh%first(e):model%mesh%first(e) + 5))
  end function solid_coordinates


  !> Those of its upper face.
  pure function coordinates_above(model, e) result(X)
    type(model_type), intent(in) :: model
    integer, intent(in) :: e                       !< CSS6
    real(DP) :: X(3, 3)                            !< [length]
    X = model%mesh%coordinates(:, model%mesh%nodes(model%mesh%first(e) + 3:model%mesh%first(e) + 5))
  end function coordinates_above


  !> Axes of a triangle, its dual base vectors and its area.
  pure subroutine find_face(X, local, dual, area)
    real(DP), intent(in) :: X(3, 3)                !< corners [length]
    real(DP), intent(out) :: local(3, 3)           !< axes in columns, the third along the normal
    real(DP), intent(out) :: dual(2, 2)            !< G^1, G^2 in rows, by the axes of the face [1/length]
    real(DP), intent(out) :: area                  !< [length^2]
    real(DP) :: base(2, 2), det
    integer :: i
    local(:, 1) = X(:, 2) - X(:, 1)
    local(:, 1) = local(:, 1) / norm2(local(:, 1))
    local(:, 3) = cross_product(X(:, 2) - X(:, 1), X(:, 3) - X(:, 1))
    local(:, 3) = local(:, 3) / norm2(local(:, 3))
    local(:, 2) = cross_product(local(:, 3), local(:, 1))
    do i = 1, 2
      base(:, i) = [dot_product(local(:, 1), X(:, i + 1) - X(:, 1)), dot_product(local(:, 2), X(:, i + 1) - X(:, 1))]
    end do
    det = base(1, 1) * base(2, 2) - base(1, 2) * base(2, 1)
    area = 0.5_DP * det
    dual = reshape([base(2, 2), -base(2, 1), -base(1, 2), base(1, 1)], [2, 2]) / det
  end subroutine find_face


  !> The elastic stiffness of a layer in plane stress, by the axes of the face; strains 11, 22 and engineering shear.
  pure subroutine evaluate_plane_stress(model, state, e, is_nlgeom, local, Q)
    type(model_type), intent(in) :: model
    type(state_type), intent(in) :: state
    integer, intent(in) :: e                       !< layer
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: local(3, 3)            !< axes in columns
    real(DP), intent(out) :: Q(3, 3)               !< [stress]
    type(integration_points_type) :: probe
    real(DP) :: c(6, 6), turn(6, 6), inverse(3, 3), det
    integer :: k
    associate (material => model%materials(max(1, material_in_step(model, state%new%step, e))), &
      nodes => model%mesh%nodes(model%mesh%first(e):model%mesh%first(e) + 5))
      probe%has_frame = allocated(state%new%frame)
      if (probe%has_frame) probe%frame(:, :, 1) = state%new%frame(:, :, model%mesh%point_first(e))
      probe%history_old = 0
      probe%temperature(:6) = state%new%temperature(nodes)
      probe%initial_temperature(:6) = probe%temperature(:6)
      k = material%table_variable * model%mesh%n_nodes
      if (k > 0) probe%field(:6) = state%new%temperature(k + nodes)
      if (k > 0) probe%initial_field(:6) = probe%field(:6)
      probe%point_field = 0
      probe%time = state%new%total_time
      probe%time_increment = 0
      call evaluate_initial_tangent(CONDITION_NONE, material, is_nlgeom, 6, probe, c)
    end associate
    turn = voigt_transformation(transpose(local))
    c = matmul(turn, matmul(c, transpose(turn)))
    call invert(c(NORMAL_PARTS, NORMAL_PARTS), inverse, det)
    Q = c(FACE_PARTS, FACE_PARTS) - matmul(c(FACE_PARTS, NORMAL_PARTS), matmul(inverse, c(NORMAL_PARTS, FACE_PARTS)))
    Q = 0.5_DP * (Q + transpose(Q))
  end subroutine evaluate_plane_stress


  !> D - B A^-1 B of a section.
  pure subroutine bend_about_neutral_surface(moments, D)
    real(DP), intent(in) :: moments(3, 3, 3)       !< A, B, D about the bottom
    real(DP), intent(out) :: D(3, 3)               !< [stress length^3]
    real(DP) :: inverse(3, 3), det
    call invert(moments(:, :, 1), inverse, det)
    D = moments(:, :, 3) - matmul(moments(:, :, 2), matmul(inverse, moments(:, :, 2)))
  end subroutine bend_about_neutral_surface

end module amontons_layer_stack
