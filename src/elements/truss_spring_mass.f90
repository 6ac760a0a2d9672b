!> Trusses, springs, unidirectional gaps and point masses.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! A truss has uniaxial stress by its material law; its cross-section changes by the law, and under
!! NLGEOM it rotates freely. A spring has a constant or a law of its own. A mass has no stiffness, only weight.
!! Theory: doc/theory/elements.md, section "Trusses, springs, gaps and masses".
module amontons_truss_spring_mass
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_kinds, only: DP, PI
  use amontons_zero_stress_condition, only: solve_zero_stress, CONDITION_UNIAXIAL
  use amontons_material_point, only: material_point_type
  use amontons_materials, only: material_type, spring_type, hardening_curve_type, evaluate_curve, evaluate_table, find_interval, &
    LAW_SAINT_VENANT
  use amontons_element_integration_points, only: integration_points_type, set_point_input, store_point_output, ELEMENT_OK, &
    ELEMENT_INVERTED, &
    ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_shape_functions, only: shape_functions, quadrature, spread_body_force
  use amontons_elasticity, only: STRESS_OK, MAX_DISPLACEMENT_GRADIENT
  use amontons_element_kinds, only: KIND_SPRINGA, KIND_SPRING1, KIND_SPRING2, KIND_GAPUNI, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS
  implicit none
  private
  public :: evaluate_truss_element, evaluate_truss_volumes, integrate_truss_body_force, evaluate_spring_element, spring_energy

contains

  !> Internal force, point values and, if requested, the tangent of a truss.
  !!
  !! With the stretch s = |dx/dxi| / |dX/dxi| the energy is sum V W(s): force_a = sum V tau dN_a/dxi x' / |x'|^2, where
  !! tau = dW/d ln s is the Kirchhoff stress along it. Stress and strain are written as components xx, along the truss.
  pure subroutine evaluate_truss_element(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind                    !< KIND_T3D2, KIND_T3D3
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< [force]
    type(integration_points_type), intent(inout) :: points     !< in: section, the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< d force/d u [force/length]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    real(DP) :: place(3), change(3), axis(3), weight(2), length, now
    type(material_point_type) :: point
    integer :: m, p, a, n_nodes
    n_nodes = size(X, 2)
    force = 0
    if (present(stiffness)) stiffness(:3 * n_nodes, :3 * n_nodes) = 0
    status = ELEMENT_NOT_FINITE
    if (.not. all(ieee_is_finite(u))) return
    call quadrature(kind, m, xi, w)
    do p = 1, m
      call shape_functions(kind, xi(:, p), N, dN)
      place = 0
      change = 0
      do a = 2, n_nodes
        place = place + (X(:, a) - X(:, 1)) * dN(1, a)
        change = change + (u(:, a) - u(:, 1)) * dN(1, a)
      end do
      length = norm2(place)
      status = ELEMENT_DEGENERATE
      if (.not. length > 0) return
      axis = place
      if (is_nlgeom) axis = place + change
      now = norm2(axis)
      status = ELEMENT_NOT_FINITE
      if (.not. now <= MAX_DISPLACEMENT_GRADIENT * length) return
      status = ELEMENT_INVERTED
      if (.not. now > 0) return
      axis = axis / now
      weight = 0.5_DP                                ! of the temperatures of the ends: one degree below the displacements
      if (m == 2) weight = 0.5_DP * [1 - xi(1, p), 1 + xi(1, p)]
      call set_point_input(material, points, p, weight, point)
      point%H = 0
      point%H(1, 1) = dot_product(place, change) / length**2
      if (is_nlgeom) point%H(1, 1) = dot_product(change, 2 * place + change) / (length * (now + length))
      call solve_zero_stress(CONDITION_UNIAXIAL, material, is_nlgeom, point, status)
      if (status /= STRESS_OK) then
        status = ELEMENT_NOT_FINITE
        return
      end if
      call store_point_output(material, is_nlgeom, point, points, p)
      points%volume(p) = w(p) * length * points%section_value
      if (.not. is_nlgeom) now = length
      associate (tau => point%stress(1), c => point%tangent(1, 1), volume => points%volume(p))
        do a = 1, n_nodes
          force(:, a) = force(:, a) + (volume * tau * dN(1, a) / now) * axis
        end do
        if (present(stiffness)) call add_truss_stiffness(n_nodes, volume / now**2, merge(tau, 0.0_DP, is_nlgeom), c, axis, dN(1, &
          :), &
          stiffness)
      end associate
    end do
    if (n_nodes == 3 .and. material%law == LAW_SAINT_VENANT) &
      call add_chord_stiffness(X, u, material%youngs_modulus * points%section_value**2, force, stiffness)
    status = ELEMENT_OK
  end subroutine evaluate_truss_element


  !> Under the calculix dialect the middle node of a straight bar of three nodes is supported on its chord by the bending stiffness
  !! of a hinged bar of square section, 48 E I / L^3 with I = A^2/12: CalculiX models it as a solid. A curved one remains free.
  pure subroutine add_chord_stiffness(X, u, rigidity, force, stiffness)
    real(DP), intent(in) :: X(:, :)                !< (3, 3) reference coordinates; the middle is the third [length]
    real(DP), intent(in) :: u(:, :)                !< (3, 3) displacements [length]
    real(DP), intent(in) :: rigidity               !< E A^2 [force length^2]
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES)
    real(DP), intent(inout), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP), parameter :: TOL_STRAIGHT = 1.0e-6_DP    !< of the length
    real(DP) :: chord(3), share(3), length, k, s
    integer :: a, b, i
    chord = X(:, 2) - X(:, 1)
    length = norm2(chord)
    s = dot_product(X(:, 3) - X(:, 1), chord) / length**2
    if (norm2(X(:, 3) - X(:, 1) - s * chord) > TOL_STRAIGHT * length) return
    share = [s - 1, -s, 1.0_DP]
    k = 4 * rigidity / length**3
    do a = 1, 3
      force(:, a) = force(:, a) + k * share(a) * matmul(u(:, :3), share)
      if (.not. present(stiffness)) cycle
      do b = 1, 3
        do i = 1, 3
          stiffness(3 * a - 3 + i, 3 * b - 3 + i) = stiffness(3 * a - 3 + i, 3 * b - 3 + i) + k * share(a) * share(b)
        end do
      end do
    end do
  end subroutine add_chord_stiffness


  !> factor * dN_a dN_b (c n n + tau 1): the change of V tau dN_a x'/|x'|^2. (tau changes by c + 2 tau with ln s, the
  !! denominator by -2 tau; the factor of n n that remains is c.)
  pure subroutine add_truss_stiffness(n_nodes, factor, tau, c, axis, slope, stiffness)
    integer, intent(in) :: n_nodes
    real(DP), intent(in) :: factor                 !< V / |x'|^2 [length]
    real(DP), intent(in) :: tau, c                 !< [stress]
    real(DP), intent(in) :: axis(3)                !< unit vector
    real(DP), intent(in) :: slope(:)               !< dN_a/dxi [-]
    real(DP), intent(inout) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: block(3, 3)
    integer :: a, b, i, j
    do j = 1, 3
      do i = 1, 3
        block(i, j) = factor * (c * (axis(i) * axis(j)) + merge(tau, 0.0_DP, i == j))
      end do
    end do
    do b = 1, n_nodes
      do a = 1, n_nodes
        associate (there => stiffness(3 * a - 2:3 * a, 3 * b - 2:3 * b))
          there = there + (slope(a) * slope(b)) * block
        end associate
      end do
    end do
  end subroutine add_truss_stiffness


  !> The reference volumes of the points of a truss.
  pure subroutine evaluate_truss_volumes(kind, X, area, n, volumes, status)
    integer, intent(in) :: kind                    !< KIND_T3D2, KIND_T3D3
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) coordinates [length]
    real(DP), intent(in) :: area                   !< [length^2]
    integer, intent(out) :: n                      !< points
    real(DP), intent(out) :: volumes(:)            !< the first n are set [length^3]
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), N_a(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    integer :: p
    call quadrature(kind, n, xi, w)
    do p = 1, n
      call shape_functions(kind, xi(:, p), N_a, dN)
      volumes(p) = w(p) * area * norm2(matmul(X, dN(1, :size(X, 2))))
    end do
    status = merge(ELEMENT_OK, ELEMENT_DEGENERATE, all(volumes(:n) > 0))
  end subroutine evaluate_truss_volumes


  !> Consistent nodal forces of a body force on a truss.
  pure subroutine integrate_truss_body_force(kind, X, area, b, force)
    integer, intent(in) :: kind                    !< KIND_T3D2, KIND_T3D3
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: area                   !< [length^2]
    real(DP), intent(in) :: b(3)                   !< force per reference volume [force/length^3]
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< zero past the nodes [force]
    real(DP) :: volumes(MAX_ELEMENT_POINTS)
    integer :: m, status
    force = 0
    call evaluate_truss_volumes(kind, X, area, m, volumes, status)
    call spread_body_force(kind, size(X, 2), volumes, b, force)
  end subroutine integrate_truss_body_force


  !> Force and, if wanted, tangent of a spring.
  !!
  !! | kind    | elongation                                                                        |
  !! |---------|-----------------------------------------------------------------------------------|
  !! | SPRINGA | change of the distance of its nodes; its line turns with them under NLGEOM        |
  !! | SPRING1 | displacement of its node in one direction, fixed in space                         |
  !! | SPRING2 | displacement of node 1 in one direction less that of node 2 in another or the same |
  !! | GAPUNI  | displacement of node 2 less that of node 1, in one direction fixed in space       |
  pure subroutine evaluate_spring_element(kind, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind                    !< KIND_SPRINGA, KIND_SPRING1, KIND_SPRING2, KIND_GAPUNI
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< [force]
    type(integration_points_type), intent(in) :: points        !< section is the spring constant [force/length], if there is no law
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< d force/d u [force/length]
    real(DP) :: row(6), tension, slope
    integer :: i, j, n
    n = size(X, 2)
    force = 0
    status = ELEMENT_NOT_FINITE
    if (.not. all(ieee_is_finite(u))) return
    if (kind == KIND_SPRINGA) then
      call evaluate_axial_spring(X, u, points, is_nlgeom, force, status, stiffness)
      return
    end if
    row = find_elongation_row(kind, X, points)
    status = ELEMENT_DEGENERATE
    if (.not. any(abs(row) > 0)) return            ! a gap without a direction
    status = ELEMENT_OK
    call evaluate_tension(points, n, dot_product(row(:3 * n), [u]), tension, slope)
    force(:, :n) = reshape(tension * row(:3 * n), [3, n])
    if (.not. present(stiffness)) return
    do j = 1, 3 * n
      do i = 1, 3 * n
        stiffness(i, j) = slope * row(i) * row(j)
      end do
    end do
  end subroutine evaluate_spring_element


  !> Energy of a spring: the integral of its tension over its elongation [energy].
  pure real(DP) function spring_energy(kind, X, u, is_nlgeom, points) result(energy)
    integer, intent(in) :: kind                    !< KIND_SPRINGA, KIND_SPRING1, KIND_SPRING2, KIND_GAPUNI
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates, evaluated before [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom
    type(integration_points_type), intent(in) :: points        !< section is the spring constant [force/length], if there is no law
    real(DP) :: row(6), elongation
    integer :: n
    n = size(X, 2)
    if (kind == KIND_SPRINGA) then
      elongation = axial_elongation(X, u, is_nlgeom)
    else
      row = find_elongation_row(kind, X, points)
      elongation = dot_product(row(:3 * n), [u])
    end if
    if (allocated(points%spring)) then
      energy = spring_law_energy(points%spring, elongation, sum(points%temperature(:n)) / real(n, DP))
    else
      energy = 0.5_DP * points%section_value * elongation**2
    end if
  end function spring_energy


  !> Tension and its derivative: by the law if there is one, else by the constant.
  pure subroutine evaluate_tension(points, n, elongation, tension, slope)
    type(integration_points_type), intent(in) :: points
    integer, intent(in) :: n                       !< nodes
    real(DP), intent(in) :: elongation             !< [length]
    real(DP), intent(out) :: tension, slope        !< [force], [force/length]
    if (allocated(points%spring)) then
      call evaluate_spring_law(points%spring, elongation, sum(points%temperature(:n)) / real(n, DP), tension, slope)
    else
      tension = points%section_value * elongation
      slope = points%section_value
    end if
  end subroutine evaluate_tension


  !> The elongation as a row times the displacements of the nodes. A gap without a direction acts along the line of its nodes.
  pure function find_elongation_row(kind, X, points) result(row)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :)
    type(integration_points_type), intent(in) :: points
    real(DP) :: row(6), axes(3, 2)
    axes = 0
    if (allocated(points%spring)) axes = points%spring%axes
    if (kind /= KIND_GAPUNI .and. .not. any(abs(axes) > 0)) then
      axes(points%directions(1), 1) = 1
      if (kind == KIND_SPRING2) axes(points%directions(2), 2) = 1
    end if
    select case (kind)
    case (KIND_SPRING1)
      row = [axes(:, 1), 0.0_DP, 0.0_DP, 0.0_DP]
    case (KIND_SPRING2)
      row = [axes(:, 1), -axes(:, 2)]
    case default
      if (.not. any(abs(axes) > 0)) axes(:, 1) = X(:, 2) - X(:, 1)
      axes(:, 1) = axes(:, 1) / max(norm2(axes(:, 1)), tiny(1.0_DP))
      row = [-axes(:, 1), axes(:, 1)]
    end select
  end function find_elongation_row


  !> A spring along the line of its two nodes.
  pure subroutine evaluate_axial_spring(X, u, points, is_nlgeom, force, status, stiffness)
    real(DP), intent(in) :: X(:, :), u(:, :)
    type(integration_points_type), intent(in) :: points
    logical, intent(in) :: is_nlgeom
    real(DP), intent(inout) :: force(3, MAX_ELEMENT_NODES)
    integer, intent(out) :: status
    real(DP), intent(inout), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP), parameter :: ENDS(2) = [-1.0_DP, 1.0_DP]
    real(DP) :: line(3), change(3), length, now, tension, slope
    line = X(:, 2) - X(:, 1)
    change = u(:, 2) - u(:, 1)
    length = norm2(line)
    status = ELEMENT_DEGENERATE
    if (.not. length > 0) return
    now = length
    if (is_nlgeom) then
      now = norm2(line + change)
      status = ELEMENT_INVERTED
      if (.not. now > 0) return
    end if
    call evaluate_tension(points, 2, axial_elongation(X, u, is_nlgeom), tension, slope)
    status = ELEMENT_OK
    if (is_nlgeom) line = line + change
    line = line / now
    force(:, 1) = -tension * line
    force(:, 2) = tension * line
    if (.not. present(stiffness)) return
    if (.not. is_nlgeom) tension = 0
    stiffness(:6, :6) = 0
    call add_truss_stiffness(2, 1.0_DP, tension / now, slope - tension / now, line, ENDS, stiffness)
  end subroutine evaluate_axial_spring


  !> Change of the distance of two nodes, without cancellation [length].
  pure real(DP) function axial_elongation(X, u, is_nlgeom)
    real(DP), intent(in) :: X(:, :), u(:, :)       !< (3, 2) [length]
    logical, intent(in) :: is_nlgeom
    real(DP) :: line(3), change(3)
    line = X(:, 2) - X(:, 1)
    change = u(:, 2) - u(:, 1)
    if (is_nlgeom) then
      axial_elongation = dot_product(change, 2 * line + change) / (norm2(line + change) + norm2(line))
    else
      axial_elongation = dot_product(line, change) / norm2(line)
    end if
  end function axial_elongation


  !> Tension of a spring and its derivative.
  !!
  !! Gap: with the overclosure d = - clearance - elongation the tension is - k d (1/2 + atan(d/eps)/pi), eps = pi f/k with
  !! the limit f = open_force at large gaps; k d when closed. Reference: CalculiX's manual, sections "GAPUNI" and "*GAP".
  pure subroutine evaluate_spring_law(spring, elongation, temperature, tension, slope)
    type(spring_type), intent(in) :: spring
    real(DP), intent(in) :: elongation           !< [length]
    real(DP), intent(in) :: temperature          !< [temperature]
    real(DP), intent(out) :: tension             !< [force]
    real(DP), intent(out) :: slope               !< d tension / d elongation [force/length]
    real(DP) :: constant(1), d, eps
    if (spring%is_gap) then
      d = -spring%clearance - elongation
      eps = PI * spring%open_force / spring%stiffness
      tension = -spring%stiffness * d * (0.5_DP + atan2(d, eps) / PI)
      slope = spring%stiffness * (0.5_DP + (atan2(d, eps) + d * eps / (d**2 + eps**2 + tiny(1.0_DP))) / PI)
    else if (spring%is_distance_limit) then
      d = elongation - spring%clearance
      slope = merge(spring%stiffness, 0.0_DP, d > 0.0_DP)
      tension = slope * d
    else if (allocated(spring%force)) then
      call interpolate_tables(spring%force, elongation, temperature, tension, slope)
    else
      call evaluate_table(spring%constant, temperature, constant)
      tension = constant(1) * elongation
      slope = constant(1)
    end if
  end subroutine evaluate_spring_law


  !> Integral of the tension of evaluate_spring_law from zero to an elongation [energy].
  pure real(DP) function spring_law_energy(spring, elongation, temperature) result(energy)
    type(spring_type), intent(in) :: spring
    real(DP), intent(in) :: elongation           !< [length]
    real(DP), intent(in) :: temperature          !< [temperature]
    real(DP) :: constant(1), s
    integer :: i
    if (spring%is_gap) then
      energy = gap_energy(-spring%clearance - elongation) - gap_energy(-spring%clearance)
    else if (spring%is_distance_limit) then
      energy = 0.5_DP * spring%stiffness * (max(elongation - spring%clearance, 0.0_DP)**2 - max(-spring%clearance, 0.0_DP)**2)
    else if (allocated(spring%force)) then
      call find_interval(spring%force%temperature, temperature, i, s)
      energy = area_under(spring%force(i), elongation)
      if (s > 0) energy = energy + s * (area_under(spring%force(i + 1), elongation) - energy)
    else
      call evaluate_table(spring%constant, temperature, constant)
      energy = 0.5_DP * constant(1) * elongation**2
    end if

  contains

    !> Of a gap, as a function of its overclosure.
    pure real(DP) function gap_energy(d)
      real(DP), intent(in) :: d                  !< [length]
      real(DP) :: eps
      eps = PI * spring%open_force / spring%stiffness
      gap_energy = spring%stiffness * (0.25_DP * d**2 + 0.5_DP * ((d**2 + eps**2) * atan2(d, eps) - eps * d) / PI)
    end function gap_energy

    !> Of a table: trapezoids between zero, its corners and the elongation.
    pure real(DP) function area_under(table, elongation) result(area)
      type(hardening_curve_type), intent(in) :: table
      real(DP), intent(in) :: elongation         !< [length]
      real(DP), allocatable :: corners(:)
      real(DP) :: f, next, unused
      integer :: k
      corners = pack(table%strain, table%strain > min(0.0_DP, elongation) .and. table%strain < max(0.0_DP, elongation))
      corners = [min(0.0_DP, elongation), corners, max(0.0_DP, elongation)]
      area = 0
      call evaluate_curve(table, corners(1), f, unused)
      do k = 2, size(corners)
        call evaluate_curve(table, corners(k), next, unused)
        area = area + 0.5_DP * (f + next) * (corners(k) - corners(k - 1))
        f = next
      end do
      if (elongation < 0) area = -area
    end function area_under

  end function spring_law_energy


  !> Force and slope by tables, linear in between and constant outside, also over the temperature.
  pure subroutine interpolate_tables(tables, elongation, temperature, force, slope)
    type(hardening_curve_type), intent(in) :: tables(:)    !< ascending temperatures
    real(DP), intent(in) :: elongation, temperature
    real(DP), intent(out) :: force, slope
    real(DP), parameter :: TOL_TABLE_POINT = 1.0e-9_DP    ! of an elongation: so near to a corner of a table it is there [-]
    real(DP) :: s, other_force, other_slope
    integer :: i
    call find_interval(tables%temperature, temperature, i, s)
    call interpolate_table(tables(i), force, slope)
    if (.not. s > 0) return
    call interpolate_table(tables(i + 1), other_force, other_slope)
    force = force + s * (other_force - force)
    slope = slope + s * (other_slope - slope)

  contains

    !> One table. At a corner of it the slope is that of the side where less is elongated: rounding does not choose.
    pure subroutine interpolate_table(table, f, df)
      type(hardening_curve_type), intent(in) :: table
      real(DP), intent(out) :: f, df
      real(DP) :: within, unused
      within = (1.0_DP - TOL_TABLE_POINT) * elongation
      call evaluate_curve(table, elongation, f, unused)
      call evaluate_curve(table, within, unused, df)
      if (within < table%strain(1)) df = 0
    end subroutine interpolate_table

  end subroutine interpolate_tables

end module amontons_truss_spring_mass
