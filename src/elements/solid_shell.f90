!> Solid shells CSS8 and CSS6: assumed natural strains against shear and thickness locking, enhanced strains against the rest.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The strains are Green's, or their linear part at small strain, in natural coordinates: E_ij = (g_i . g_j - G_i . G_j)/2. The
!! third coordinate runs from the bottom face to the top face.
!!
!! | strain | CSS8 | CSS6 |
!! |---|---|---|
!! | 11, 22, 12 | of the displacements, that of warping by those of the edges (MITC4+) | of the displacements |
!! | 13, 23 | two places each in the middle of the edges (Dvorkin, Bathe) | three edges (Lee, Bathe: MITC3), what varies reduced |
!! | 33 | the four corners (Betsch, Stein) | the three corners |
!!
!! To them are added strains with amplitudes of the element that vanish in the mean: xi in 11, eta in 22, both in 12 (bending in
!! the plane; CSS8 only), and zeta times the functions of a face in 33 (Poisson's strain of bending). CSS6 of a shell has the turns
!! of a fibre in the middle, too (MITC3+). In a stack they are shear strains, whose energy is that of bending the whole stack.
!!
!! The law is that of solids, at the deformation gradient R U: U^2 = 1 + 2 E, R the rotation of the displacements.
!!
!! Inside, the unknowns are the means and half differences of the nodes of a fibre, bottom and top (`pair_slopes`): the stiffness
!! of the thickness exceeds that of bending by (length/thickness)^4, and rounding of the one should not spoil the other.
!!
!! References: E. N. Dvorkin, K.-J. Bathe, A continuum mechanics based four-node shell element for general non-linear analysis, Eng.
!! Comput. 1 (1984) 77-88; P. Betsch, E. Stein, An assumed strain approach avoiding artificial thickness straining for a non-linear
!! 4-node shell element, Commun. Numer. Meth. Engng 11 (1995) 899-909; S. Klinkel, F. Gruttmann, W. Wagner, A continuum based
!! three-dimensional shell element for laminated structures, Comput. Struct. 71 (1999) 43-62; L. Vu-Quoc, X. G. Tan, Optimal solid
!! shells for non-linear analyses of multilayer composites, Comput. Methods Appl. Mech. Engrg. 192 (2003) 975-1016; P.-S. Lee,
!! K.-J. Bathe, Development of MITC isotropic triangular shell finite elements, Comput. Struct. 82 (2004) 945-962; Y. Lee, P.-S.
!! Lee, K.-J. Bathe, The MITC3+ shell element and its performance, Comput. Struct. 138 (2014) 12-23; Y. Ko, P.-S. Lee, K.-J. Bathe,
!! A new MITC4+ shell element, Comput. Struct. 182 (2017) 404-418.
module amontons_solid_shell
  use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
  use amontons_elasticity, only: STRESS_OK, STRESS_INVERTED, MAX_DISPLACEMENT_GRADIENT
  use amontons_incompatible_modes, only: mode_iteration_type, update_mode_amplitudes, halve_mode_correction, &
    condense_mode_amplitudes, N_MODES, MAX_AMPLITUDE_CORRECTIONS, TOL_MODE_FORCE, TOL_MODE_FORCE_ACCEPTABLE
  use amontons_element_integration_points, only: integration_points_type, set_point_input, store_point_output, &
    split_unsymmetric_tangent, ELEMENT_OK, ELEMENT_INVERTED, ELEMENT_NOT_FINITE, ELEMENT_DEGENERATE
  use amontons_kinds, only: DP
  use amontons_logarithmic_strain, only: voigt_transformation
  use amontons_material_point, only: material_point_type
  use amontons_materials, only: material_type
  use amontons_shape_functions, only: shape_functions, quadrature
  use amontons_tensor, only: IDENTITY, VOIGT_ROW, VOIGT_COLUMN, determinant_minus_one, invert, outer_product, pack_voigt, &
    symmetric_eigen
  use amontons_element_kinds, only: KIND_CSS6, KIND_CSS8, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS
  use amontons_zero_stress_condition, only: solve_zero_stress, CONDITION_NONE
  implicit none
  private
  public :: evaluate_solid_shell, set_layer_temperature_weights, find_rotation, evaluate_stress_of_strain, natural_strain

  integer, parameter :: MAX_NODES = 8              !< of a solid shell
  integer, parameter :: MAX_POINTS = 20
  integer, parameter :: MAX_SAMPLES = 15           !< places of strains
  integer, parameter :: MAX_DOF = 3 * (MAX_NODES + N_MODES)

  !> A natural strain at a place of the middle face.
  type :: sample_type
    integer :: i = 0, j = 0                        !< its indices
    real(DP) :: slope(3, MAX_NODES) = 0            !< derivatives by the natural coordinates, of means and half differences [-]
    real(DP) :: base(3, 3) = 0                     !< G_1, G_2, G_3 in columns [length]
    real(DP) :: weight(6, MAX_POINTS) = 0          !< its part of the assumed strains at the points, Voigt order [-]
  end type sample_type

  !> An element at rest.
  type :: shell_at_rest_type
    integer :: n = 0, n_points = 0, n_samples = 0  !< nodes, integration points, places of strains
    integer :: n_amplitudes = 0                    !< numbers in use of the 3 * N_MODES
    type(sample_type) :: samples(MAX_SAMPLES)
    real(DP) :: slope(3, MAX_NODES, MAX_POINTS)    !< derivatives, of means and half differences [-]
    real(DP) :: base(3, 3, MAX_POINTS)             !< G_1, G_2, G_3 in columns [length]
    real(DP) :: dual(3, 3, MAX_POINTS)             !< G^1, G^2, G^3 in rows [1/length]
    real(DP) :: to_cartesian(6, 6, MAX_POINTS)     !< natural strains to those of the global axes, engineering shears [1/length^2]
    real(DP) :: modes(6, 3 * N_MODES, MAX_POINTS)  !< strains of the amplitudes, engineering shears [1/length]
    real(DP) :: volume(MAX_POINTS)                 !< [length^3]
    real(DP) :: stack_bending(3 * N_MODES, 3 * N_MODES) = 0    !< second derivatives of the energy of the stack by the amplitudes
                                                   !! [stress length]
  end type shell_at_rest_type

  !> Its strains at given displacements, without those of the amplitudes.
  type :: layer_strains_type
    real(DP) :: strain(6, MAX_POINTS)              !< global axes, engineering shears [-]
    real(DP) :: B(MAX_DOF, 6, MAX_POINTS)          !< derivatives by means, half differences and amplitudes [1/length]
    real(DP) :: turn(3, 3, MAX_POINTS)             !< R - 1 [-]
  end type layer_strains_type

contains

  !> Internal force, point values and, if requested, the tangent of a solid shell.
  !!
  !! The amplitudes are solved for in the element, from the committed ones; they are those of strains and turn with the element. If
  !! that fails, once more from zero.
  pure subroutine evaluate_solid_shell(kind, material, X, u, is_nlgeom, force, points, status, stiffness)
    integer, intent(in) :: kind                    !< KIND_CSS8 or KIND_CSS6
    type(material_type), intent(in) :: material
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) reference coordinates [length]
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: force(3, MAX_ELEMENT_NODES)   !< [force]
    type(integration_points_type), intent(inout) :: points     !< in: the past; out: the point values
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP), intent(out), optional :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< d force/d u [force/length]
    type(shell_at_rest_type) :: reference
    type(layer_strains_type) :: kinematics
    real(DP) :: S(6, MAX_POINTS), C(6, 6, MAX_POINTS), whole(3, MAX_NODES + N_MODES)
    logical :: is_regular
    force = 0
    call set_reference(kind, X, points%is_shell, points%stack_bending, reference, status)
    if (status /= ELEMENT_OK) return
    call set_kinematics(reference, u, is_nlgeom, kinematics, status)
    if (status /= ELEMENT_OK) return
    associate (n => reference%n)
      whole(:, :n) = u(:, :n)
      whole(:, n + 1:n + N_MODES) = reshape(points%modes_old, [3, N_MODES])
      call solve_amplitudes(material, is_nlgeom, reference, kinematics, whole(:, :n + N_MODES), points, S, C, status)
      if (status /= ELEMENT_OK .and. any(abs(points%modes_old) > 0)) then
        whole(:, n + 1:n + N_MODES) = 0
        call solve_amplitudes(material, is_nlgeom, reference, kinematics, whole(:, :n + N_MODES), points, S, C, status)
      end if
      if (status /= ELEMENT_OK) return
      points%modes(:3 * N_MODES) = reshape(whole(:, n + 1:n + N_MODES), [3 * N_MODES])
      force(:, :n + N_MODES) = reshape(stress_forces(reference, kinematics, S, 1), [3, n + N_MODES])
      force(:, n + 1:n + N_MODES) = force(:, n + 1:n + N_MODES) + reshape(matmul(reference%stack_bending, &
        points%modes(:3 * N_MODES)), [3, N_MODES])
      points%energy(:reference%n_points) = points%energy(:reference%n_points) + 0.5_DP * dot_product(points%modes(:3 * N_MODES), &
        matmul(reference%stack_bending, points%modes(:3 * N_MODES))) / sum(reference%volume(:reference%n_points))
      if (present(stiffness)) then
        call integrate_stiffness(reference, kinematics, C, 1, .not. allocated(points%skew), stiffness)
        if (is_nlgeom) call add_geometric_stiffness(reference, S, stiffness)
        call condense_mode_amplitudes(n, .not. allocated(points%skew), force, stiffness, is_regular)
        call part_stiffness(3 * n / 2, stiffness)
        call balance_translations(n, .not. allocated(points%skew), stiffness)
      end if
      force(:, :n) = 0.5_DP * reshape([force(:, :n / 2) - force(:, n / 2 + 1:n), force(:, :n / 2) + force(:, n / 2 + 1:n)], [3, n])
      force(:, n + 1:) = 0
    end associate
  end subroutine evaluate_solid_shell


  !> Weights of the nodal temperatures: linear over the thickness between the means of both faces, as the strains of the element.
  pure subroutine set_layer_temperature_weights(kind, weight)
    integer, intent(in) :: kind                    !< KIND_CSS8 or KIND_CSS6
    real(DP), intent(out) :: weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)   !< [-]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS)
    integer :: n, p, n_points
    n = merge(4, 3, kind == KIND_CSS8)
    weight = 0
    call quadrature(kind, n_points, xi, w)
    do p = 1, n_points
      weight(:n, p) = 0.5_DP * (1 - xi(3, p)) / real(n, DP)
      weight(n + 1:2 * n, p) = 0.5_DP * (1 + xi(3, p)) / real(n, DP)
    end do
  end subroutine set_layer_temperature_weights


  !> Everything that does not depend on the displacements.
  pure subroutine set_reference(kind, X, is_whole, stack_bending, reference, status)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :)
    logical, intent(in) :: is_whole                !< CSS6: the only layer of a shell
    real(DP), intent(in) :: stack_bending(2, 2)    !< CSS6, one of several layers: of the bubble, else 0 [stress/length]
    type(shell_at_rest_type), intent(out) :: reference
    integer, intent(out) :: status                 !< ELEMENT_OK or ELEMENT_DEGENERATE
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), w(MAX_ELEMENT_POINTS), centre(3), slope(3, MAX_NODES), base(3, 3), dual(3, 3)
    real(DP) :: length(3), size_of, det, det_centre, natural(6, 3 * N_MODES), map(6, 6)
    integer :: p, k
    status = ELEMENT_OK
    call quadrature(kind, reference%n_points, xi, w)
    reference%n = merge(8, 6, kind == KIND_CSS8)
    do p = 1, reference%n_points
      call place_base(kind, X, xi(:, p), reference%slope(:, :, p), reference%base(:, :, p))
      call invert(reference%base(:, :, p), reference%dual(:, :, p), det)
      if (.not. det > 0) status = ELEMENT_DEGENERATE
      reference%volume(p) = w(p) * det
      reference%to_cartesian(:, :, p) = transpose(voigt_transformation(reference%dual(:, :, p)))
    end do
    if (status /= ELEMENT_OK) return
    centre = 0
    if (kind /= KIND_CSS8) centre(:2) = 1.0_DP / 3
    call place_base(kind, X, centre, slope, base)
    call invert(base, dual, det_centre)
    if (.not. det_centre > 0) status = ELEMENT_DEGENERATE
    length = norm2(base, 1)
    call set_samples(kind, X, xi, twist_share(base), reference)
    size_of = sum(reference%volume(:reference%n_points))**(1 / 3.0_DP)
    map = transpose(voigt_transformation(dual))
    do k = 1, 6                                    ! strains of one at amplitudes of the element's size
      map(:, k) = map(:, k) * length(VOIGT_ROW(k)) * length(VOIGT_COLUMN(k)) / size_of
    end do
    do p = 1, reference%n_points
      call natural_modes(kind, is_whole, any(abs(stack_bending) > 0), xi(:, p), length, reference%n_amplitudes, natural)
      reference%modes(:, :, p) = (det_centre * w(p) / reference%volume(p)) * matmul(map, natural)
    end do
    do k = 1, 2
      reference%stack_bending(4:5, 3 + k) = stack_bending(:, k) * (length(:2) * length(k) / size_of)**2
    end do
  end subroutine set_reference


  !> Derivatives of the shape functions and base vectors at a place.
  pure subroutine place_base(kind, X, xi, slope, base)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :), xi(3)
    real(DP), intent(out) :: slope(3, MAX_NODES), base(3, 3)
    real(DP) :: N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES)
    call shape_functions(kind, xi, N, dN)
    slope = pair_slopes(merge(4, 3, kind == KIND_CSS8), dN(:, :MAX_NODES))
    base = relative_slopes(merge(4, 3, kind == KIND_CSS8), X, slope)
  end subroutine place_base


  !> From the derivatives of nodes to those of means m and half differences d of fibres: bottom m - d, top m + d.
  pure function pair_slopes(n, nodal) result(slope)
    integer, intent(in) :: n                       !< fibres
    real(DP), intent(in) :: nodal(3, MAX_NODES)
    real(DP) :: slope(3, MAX_NODES)
    slope = 0
    slope(:, :n) = nodal(:, :n) + nodal(:, n + 1:2 * n)
    slope(:, n + 1:2 * n) = nodal(:, n + 1:2 * n) - nodal(:, :n)
  end function pair_slopes


  !> From the stiffness of means and half differences to that of nodes.
  pure subroutine part_stiffness(n, K)
    integer, intent(in) :: n                       !< unknowns of one face
    real(DP), intent(inout) :: K(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: even(n, n), odd(n, n), mixed(n, n), turned(n, n)
    even = K(:n, :n) + K(n + 1:2 * n, n + 1:2 * n)
    odd = K(:n, :n) - K(n + 1:2 * n, n + 1:2 * n)
    mixed = K(:n, n + 1:2 * n) + K(n + 1:2 * n, :n)
    turned = K(:n, n + 1:2 * n) - K(n + 1:2 * n, :n)
    K(:n, :n) = 0.25_DP * (even - mixed)
    K(:n, n + 1:2 * n) = 0.25_DP * (odd + turned)
    K(n + 1:2 * n, :n) = 0.25_DP * (odd - turned)
    K(n + 1:2 * n, n + 1:2 * n) = 0.25_DP * (even + mixed)
  end subroutine part_stiffness


  !> The derivatives of a field by the natural coordinates, in columns; a uniform field gives exactly zero.
  pure function relative_slopes(n, values, slope) result(base)
    integer, intent(in) :: n                       !< fibres
    real(DP), intent(in) :: values(:, :), slope(3, MAX_NODES)
    real(DP) :: base(3, 3), mean(3), difference(3)
    integer :: a, i
    base = 0
    do a = 1, n
      mean = 0.5_DP * ((values(:, a) - values(:, 1)) + (values(:, a + n) - values(:, 1)))
      difference = 0.5_DP * (values(:, a + n) - values(:, a))
      do i = 1, 3
        base(:, i) = base(:, i) + slope(i, a) * mean + slope(i, a + n) * difference
      end do
    end do
  end function relative_slopes


  !> The places of the assumed strains and their parts at the points.
  pure subroutine set_samples(kind, X, xi, twist, reference)
    integer, intent(in) :: kind
    real(DP), intent(in) :: X(:, :), xi(3, MAX_ELEMENT_POINTS)
    real(DP), intent(in) :: twist                  !< CSS6: share of the transverse shear strains that vary over the face [-]
    type(shell_at_rest_type), intent(inout) :: reference
    real(DP), parameter :: HALF = 0.5_DP, THIRD = 1.0_DP / 3
    real(DP), parameter :: SIGNS(2, 4) = reshape([real(DP) :: -1, -1, 1, -1, 1, 1, -1, 1], [2, 4])
    real(DP), parameter :: PLACES_8(2, 15) = reshape([real(DP) :: 0, -1, 0, 1, -1, 0, 1, 0, SIGNS, &
      0, 0, 0, 0, 0, 0, 0, 1, 0, -1, 1, 0, -1, 0], [2, 15])
    real(DP), parameter :: PLACES_6(2, 7) = reshape([real(DP) :: HALF, 0, 0, HALF, HALF, HALF, HALF, HALF, &
      0, 0, 1, 0, 0, 1], [2, 7])
    integer, parameter :: PAIRS_8(2, 15) = reshape([1, 3, 1, 3, 2, 3, 2, 3, 3, 3, 3, 3, 3, 3, 3, 3, &
      1, 1, 2, 2, 1, 2, 1, 1, 1, 1, 2, 2, 2, 2], [2, 15])
    integer, parameter :: PAIRS_6(2, 7) = reshape([1, 3, 2, 3, 1, 3, 2, 3, 3, 3, 3, 3, 3, 3], [2, 7])
    real(DP) :: r, s, q(2), place(3), warping(7)
    integer :: m, p
    reference%n_samples = merge(15, 7, kind == KIND_CSS8)
    place = 0
    do m = 1, reference%n_samples
      associate (sample => reference%samples(m))
        if (kind == KIND_CSS8) then
          place(:2) = PLACES_8(:, m)
          sample%i = PAIRS_8(1, m)
          sample%j = PAIRS_8(2, m)
        else
          place(:2) = PLACES_6(:, m)
          sample%i = PAIRS_6(1, m)
          sample%j = PAIRS_6(2, m)
        end if
        call place_base(kind, X, place, sample%slope, sample%base)
      end associate
    end do
    if (kind == KIND_CSS8) call find_warping_weights(reference%samples(9:15), warping)
    do p = 1, reference%n_points
      r = xi(1, p)
      s = xi(2, p)
      associate (samples => reference%samples)
        if (kind == KIND_CSS8) then
          samples(1)%weight(6, p) = HALF * (1 - s)
          samples(2)%weight(6, p) = HALF * (1 + s)
          samples(3)%weight(5, p) = HALF * (1 - r)
          samples(4)%weight(5, p) = HALF * (1 + r)
          do m = 1, 4
            samples(4 + m)%weight(3, p) = HALF**2 * (1 + SIGNS(1, m) * r) * (1 + SIGNS(2, m) * s)
          end do
          do m = 1, 7
            samples(8 + m)%weight([1, 2, 4], p) = warping(m) * [s**2 - 1, r**2 - 1, 2 * r * s]
          end do
        else
          q = THIRD + twist * (xi(:2, p) - THIRD)
          samples(1)%weight(5:6, p) = [q(1), 1 - q(2)]
          samples(2)%weight(5:6, p) = [1 - q(1), q(2)]
          samples(3)%weight(5:6, p) = [-q(1), q(2)]
          samples(4)%weight(5:6, p) = [q(1), -q(2)]
          samples(5)%weight(3, p) = 1 - r - s
          samples(6)%weight(3, p) = r
          samples(7)%weight(3, p) = s
        end if
      end associate
    end do
  end subroutine set_samples


  !> The parts of the strains at seven places in what takes the strain of warping out of the membrane strains (Ko, Lee, Bathe).
  !!
  !! With x = x_0 + r x_r + s x_s + r s x_d on the middle face E_11, E_22 and E_12 hold the term c = x_d . u_d + |u_d|^2/2 with
  !! the factors s^2, r^2 and r s. Where x_d = c_1 x_r + c_2 x_s (plane faces) c follows from the other terms. This value takes the
  !! place of c, which would not vanish where a warped face bends; the strains at the middles of the four edges stay.
  pure subroutine find_warping_weights(samples, weight)
    type(sample_type), intent(in) :: samples(7)    !< 11, 22, 12 at the centre; 11 at s = 1, -1; 22 at r = 1, -1
    real(DP), intent(out) :: weight(7)             !< [-]
    real(DP), parameter :: MIN_CONVEXITY = 0.1_DP        !< below lie faces that are nearly triangles [-]
    real(DP) :: metric(3), right(2), c(2), warp(3)
    associate (base => samples(1)%base)
      warp = samples(4)%base(:, 1) - base(:, 1)
      metric = [dot_product(base(:, 1), base(:, 1)), dot_product(base(:, 2), base(:, 2)), dot_product(base(:, 1), base(:, 2))]
      right = [dot_product(base(:, 1), warp), dot_product(base(:, 2), warp)]
    end associate
    c = [metric(2) * right(1) - metric(3) * right(2), metric(1) * right(2) - metric(3) * right(1)] / &
      (metric(1) * metric(2) - metric(3)**2)
    weight = [1 - c(1)**2, -c(2)**2, -c(1) * c(2), 0.5_DP * (c(1) - 1), -0.5_DP * (c(1) + 1), 0.5_DP * c(2), -0.5_DP * c(2)] / &
      max(1 - c(1)**2 - c(2)**2, MIN_CONVEXITY)
  end subroutine find_warping_weights


  !> CSS6: the share of the transverse shear strains that vary over the face. They belong to a twist of the fibres about the
  !! normal of the face that the bending of thin shells does not need, and lock by (size/thickness)^2; with this share their energy
  !! is that of bending, and a thick element keeps them whole.
  pure real(DP) function twist_share(base) result(share)
    real(DP), intent(in) :: base(3, 3)             !< at the centre [length]
    real(DP) :: thickness, edges                   !< squares
    thickness = 4 * sum(base(:, 3)**2)
    edges = (sum(base(:, 1)**2) + sum(base(:, 2)**2) + sum((base(:, 1) - base(:, 2))**2)) / 3
    share = sqrt(thickness / (thickness + edges))
  end function twist_share


  !> The natural strains of the amplitudes at a place. Their mean over the parent element is zero, but for the transverse shear of
  !! the two that turn the fibre in the middle of CSS6 (the bubble of MITC3+, f = 27 r s (1 - r - s), tied to f = 1/2).
  !!
  !! Slopes of the bubble are times 4/3: then the moments at the points and the shear force are in equilibrium, M_ij,j = Q_i.
  pure subroutine natural_modes(kind, is_whole, is_stacked, xi, length, n, modes)
    integer, intent(in) :: kind
    logical, intent(in) :: is_whole, is_stacked    !< CSS6: the only layer of a shell, one of several
    real(DP), intent(in) :: xi(3), length(3)       !< length: of the base vectors at the centre [length]
    integer, intent(out) :: n                      !< amplitudes in use
    real(DP), intent(out) :: modes(6, 3 * N_MODES) !< zero past n, over the lengths of both base vectors [-]
    real(DP) :: slope(2)
    modes = 0
    if (kind == KIND_CSS8) then
      n = 8
      modes(1, 1) = xi(1)
      modes(2, 2) = xi(2)
      modes(4, 3:4) = xi(:2)
      modes(3, 5:8) = xi(3) * [1.0_DP, xi(1), xi(2), xi(1) * xi(2)]
    else
      n = merge(5, 3, is_whole .or. is_stacked)
      modes(3, :3) = xi(3) * [1.0_DP, xi(1) - 1.0_DP / 3, xi(2) - 1.0_DP / 3]
      if (n == 3) return
      slope = 0
      if (is_whole) slope = 36 * xi(3) * xi([2, 1]) * (1 - 2 * xi(:2) - xi([2, 1]))
      modes([1, 4, 6], 4) = [slope(1), slope(2) * length(1) / length(2), 0.5_DP * length(1) / length(3)]
      modes([2, 4, 5], 5) = [slope(2), slope(1) * length(2) / length(1), 0.5_DP * length(2) / length(3)]
    end if
  end subroutine natural_modes


  !> The assumed strains, their derivatives by the displacements, and the rotations.
  pure subroutine set_kinematics(reference, u, is_nlgeom, kinematics, status)
    type(shell_at_rest_type), intent(in) :: reference
    real(DP), intent(in) :: u(:, :)
    logical, intent(in) :: is_nlgeom
    type(layer_strains_type), intent(out) :: kinematics
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP) :: sampled(MAX_SAMPLES), rows(3 * MAX_NODES, MAX_SAMPLES), natural(6), d(3 * MAX_NODES, 6), v(3, 3)
    integer, parameter :: IN_PLANE(3) = [1, 2, 4]
    integer :: m, p, k, l, n_dof
    status = ELEMENT_NOT_FINITE
    if (.not. all(ieee_is_finite(u(:, :reference%n)))) return
    n_dof = 3 * reference%n
    do m = 1, reference%n_samples
      associate (sample => reference%samples(m))
        v = relative_slopes(reference%n / 2, u, sample%slope)
        call natural_strain(sample%i, sample%j, sample%slope, sample%base, v, is_nlgeom, sampled(m), rows(:, m))
      end associate
    end do
    do p = 1, reference%n_points
      v = relative_slopes(reference%n / 2, u, reference%slope(:, :, p))
      if (is_nlgeom) then
        call find_rotation(matmul(v, reference%dual(:, :, p)), kinematics%turn(:, :, p), status)
        if (status /= ELEMENT_OK) return
      end if
      natural = 0
      d = 0
      do k = 1, 3
        l = IN_PLANE(k)
        call natural_strain(VOIGT_ROW(l), VOIGT_COLUMN(l), reference%slope(:, :, p), reference%base(:, :, p), v, is_nlgeom, &
          natural(l), d(:, l))
      end do
      do m = 1, reference%n_samples
        do l = 1, 6
          if (.not. abs(reference%samples(m)%weight(l, p)) > 0) cycle
          natural(l) = natural(l) + reference%samples(m)%weight(l, p) * sampled(m)
          d(:, l) = d(:, l) + reference%samples(m)%weight(l, p) * rows(:, m)
        end do
      end do
      kinematics%strain(:, p) = matmul(reference%to_cartesian(:, :, p), natural)
      kinematics%B(:n_dof, :, p) = matmul(d(:n_dof, :), transpose(reference%to_cartesian(:, :, p)))
      kinematics%B(n_dof + 1:n_dof + 3 * N_MODES, :, p) = transpose(reference%modes(:, :, p))
    end do
    status = ELEMENT_OK
  end subroutine set_kinematics


  !> A natural strain (twice it for i /= j) and its derivatives by the displacements to which the slopes belong.
  pure subroutine natural_strain(i, j, slope, base, v, is_nlgeom, value, row)
    integer, intent(in) :: i, j
    real(DP), intent(in) :: slope(:, :)            !< (3, n) derivatives of the functions of the displacements
    real(DP), intent(in) :: base(3, 3), v(3, 3)    !< v: derivatives of the displacements [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: value                 !< [length^2]
    real(DP), intent(out) :: row(:)                !< (3 n) [length]
    real(DP) :: factor, g_i(3), g_j(3)
    integer :: a
    factor = merge(0.5_DP, 1.0_DP, i == j)
    g_i = base(:, i)
    g_j = base(:, j)
    value = dot_product(g_i, v(:, j)) + dot_product(g_j, v(:, i))
    if (is_nlgeom) then
      value = value + dot_product(v(:, i), v(:, j))
      g_i = g_i + v(:, i)
      g_j = g_j + v(:, j)
    end if
    value = factor * value
    do a = 1, size(slope, 2)
      row(3 * a - 2:3 * a) = factor * (slope(i, a) * g_j + slope(j, a) * g_i)
    end do
  end subroutine natural_strain


  !> R - 1 of the polar decomposition 1 + H = R U: (H - (U - 1)) U^-1, without cancellation.
  pure subroutine find_rotation(H, turn, status)
    real(DP), intent(in) :: H(3, 3)                !< displacement gradient [-]
    real(DP), intent(out) :: turn(3, 3)
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP) :: x(3), axes(3, 3), inverse(3, 3)
    integer :: k
    turn = 0
    status = ELEMENT_NOT_FINITE
    if (.not. all(abs(H) <= MAX_DISPLACEMENT_GRADIENT)) return
    status = ELEMENT_INVERTED
    if (.not. determinant_minus_one(H) > -1) return
    call symmetric_eigen(pack_voigt(H + transpose(H) + matmul(transpose(H), H)), x, axes)
    if (.not. minval(x) > -1) return
    inverse = 0
    do k = 1, 3
      inverse = inverse + outer_product(axes(:, k), axes(:, k)) / sqrt(1 + x(k))
    end do
    turn = matmul(H - stretch_minus_one(x, axes), inverse)
    status = ELEMENT_OK
  end subroutine find_rotation


  !> U - 1 of U^2 = 1 + sum of x_k n_k n_k.
  pure function stretch_minus_one(x, axes) result(stretch)
    real(DP), intent(in) :: x(3), axes(3, 3)       !< eigenvalues of U^2 - 1, axes in columns [-]
    real(DP) :: stretch(3, 3)
    integer :: k
    stretch = 0
    do k = 1, 3
      stretch = stretch + (x(k) / (1 + sqrt(1 + x(k)))) * outer_product(axes(:, k), axes(:, k))
    end do
  end function stretch_minus_one


  !> Newton's method for the amplitudes, with the stresses and tangents there. A correction to impossible strains is halved.
  pure subroutine solve_amplitudes(material, is_nlgeom, reference, kinematics, whole, points, S, C, status)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(shell_at_rest_type), intent(in) :: reference
    type(layer_strains_type), intent(in) :: kinematics
    real(DP), intent(inout) :: whole(:, :)         !< (3, n + N_MODES) displacements, then amplitudes [length]
    type(integration_points_type), intent(inout) :: points
    real(DP), intent(out) :: S(6, MAX_POINTS)      !< second Piola-Kirchhoff stresses [stress]
    real(DP), intent(out) :: C(6, 6, MAX_POINTS)   !< their derivatives, engineering shears [stress]
    integer, intent(out) :: status                 !< ELEMENT_...; ELEMENT_NOT_FINITE without convergence
    type(mode_iteration_type) :: iteration
    real(DP) :: force(3, MAX_ELEMENT_NODES), K(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES), residual, scale
    integer :: step, p, first
    logical :: is_exact, is_regular
    first = 3 * reference%n + 1
    residual = huge(1.0_DP)
    force = 0
    do step = 0, MAX_AMPLITUDE_CORRECTIONS
      call evaluate_stresses(material, is_nlgeom, reference, kinematics, reshape(whole(:, reference%n + 1:), [3 * N_MODES]), &
        points, S, C, status)
      if (status /= ELEMENT_OK) then
        call halve_mode_correction(iteration, whole(:, reference%n + 1:), is_regular)
        if (.not. is_regular) return
        cycle
      end if
      force(:, reference%n + 1:reference%n + N_MODES) = reshape(stress_forces(reference, kinematics, S, first) + &
        matmul(reference%stack_bending, reshape(whole(:, reference%n + 1:), [3 * N_MODES])), [3, N_MODES])
      scale = tiny(1.0_DP)
      do p = 1, reference%n_points
        scale = scale + reference%volume(p) * norm2(S(:, p)) * norm2(reference%modes(:, :, p))
      end do
      residual = norm2(force) / scale
      if (residual <= TOL_MODE_FORCE) exit
      call integrate_stiffness(reference, kinematics, C, first, .not. allocated(points%skew), K)
      call update_mode_amplitudes(iteration, reference%n, force, K, whole, is_exact, is_regular)
      if (is_exact) residual = 0
      if (is_exact .or. .not. is_regular) exit
    end do
    if (status == ELEMENT_OK .and. .not. residual <= TOL_MODE_FORCE_ACCEPTABLE) status = ELEMENT_NOT_FINITE
  end subroutine solve_amplitudes


  !> Second Piola-Kirchhoff stresses and their derivatives by Green's strain at all points.
  pure subroutine evaluate_stresses(material, is_nlgeom, reference, kinematics, amplitudes, points, S, C, status)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    type(shell_at_rest_type), intent(in) :: reference
    type(layer_strains_type), intent(in) :: kinematics
    real(DP), intent(in) :: amplitudes(:)          !< (3 * N_MODES) [length]
    type(integration_points_type), intent(inout) :: points
    real(DP), intent(out) :: S(6, MAX_POINTS), C(6, 6, MAX_POINTS)
    integer, intent(out) :: status                 !< ELEMENT_...
    type(material_point_type) :: point
    real(DP) :: strain(6), weight(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS)
    integer :: p
    call set_layer_temperature_weights(kind_of(reference), weight)
    do p = 1, reference%n_points
      call set_point_input(material, points, p, weight(:reference%n, p), point)
      strain = kinematics%strain(:, p) + matmul(reference%modes(:, :, p), amplitudes)
      call evaluate_stress_of_strain(material, is_nlgeom, strain, kinematics%turn(:, :, p), p, point, points, status)
      if (status /= ELEMENT_OK) return
      points%volume(p) = reference%volume(p)
      S(:, p) = point%stress
      C(:, :, p) = point%tangent
    end do
  end subroutine evaluate_stresses


  !> Second Piola-Kirchhoff stress of a point and its derivative by Green's strain, or those of small strain.
  pure subroutine evaluate_stress_of_strain(material, is_nlgeom, strain, turn, p, point, points, status)
    type(material_type), intent(in) :: material
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: strain(6)              !< engineering shears [-]
    real(DP), intent(in) :: turn(3, 3)             !< R - 1; looked at at finite strain only
    integer, intent(in) :: p                       !< point
    type(material_point_type), intent(inout) :: point   !< in: of set_point_input; out: stress and tangent [stress]
    type(integration_points_type), intent(inout) :: points
    integer, intent(out) :: status                 !< ELEMENT_...
    real(DP) :: inverse(3, 3), det, map(6, 6)
    integer :: state
    call find_stretched_gradient(strain, is_nlgeom, turn, point%H, state)
    if (state == STRESS_OK) call solve_zero_stress(CONDITION_NONE, material, is_nlgeom, point, state)
    if (state /= STRESS_OK) then
      status = merge(ELEMENT_INVERTED, ELEMENT_NOT_FINITE, state == STRESS_INVERTED)
      return
    end if
    status = ELEMENT_OK
    call split_unsymmetric_tangent(material, point, points, p)
    call store_point_output(material, is_nlgeom, point, points, p)
    if (allocated(points%skew)) point%tangent = point%tangent + points%skew(:, :, p)
    if (.not. is_nlgeom) return
    call invert(IDENTITY + point%H, inverse, det)
    map = voigt_transformation(inverse)
    point%stress = matmul(map, point%stress)
    point%tangent = matmul(map, matmul(point%tangent, transpose(map)))
  end subroutine evaluate_stress_of_strain


  !> The kind of an element at rest.
  pure integer function kind_of(reference)
    type(shell_at_rest_type), intent(in) :: reference
    kind_of = merge(KIND_CSS8, KIND_CSS6, reference%n == 8)
  end function kind_of


  !> The displacement gradient of a strain: the symmetric one at small strain, else R U - 1 = (U - 1) + (R - 1) + (R - 1)(U - 1).
  pure subroutine find_stretched_gradient(strain, is_nlgeom, turn, H, state)
    real(DP), intent(in) :: strain(6)              !< engineering shears [-]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: turn(3, 3)             !< R - 1; looked at at finite strain only
    real(DP), intent(out) :: H(3, 3)
    integer, intent(out) :: state                  !< STRESS_OK, or STRESS_INVERTED where no stretch has this strain
    real(DP) :: x(3), axes(3, 3), twice(6), stretch(3, 3)
    state = STRESS_OK
    twice = [2 * strain(:3), strain(4:)]
    if (.not. is_nlgeom) then
      H = 0.5_DP * reshape(twice([1, 4, 6, 4, 2, 5, 6, 5, 3]), [3, 3])
      return
    end if
    H = 0
    state = STRESS_INVERTED
    call symmetric_eigen(twice, x, axes)
    if (.not. minval(x) > -1) return
    stretch = stretch_minus_one(x, axes)
    H = stretch + turn + matmul(turn, stretch)
    state = STRESS_OK
  end subroutine find_stretched_gradient


  !> The forces of the stresses on displacements and amplitudes, from a given unknown on.
  pure function stress_forces(reference, kinematics, S, first) result(force)
    type(shell_at_rest_type), intent(in) :: reference
    type(layer_strains_type), intent(in) :: kinematics
    real(DP), intent(in) :: S(6, MAX_POINTS)       !< [stress]
    integer, intent(in) :: first
    real(DP) :: force(3 * (reference%n + N_MODES) + 1 - first)   !< [force]
    integer :: p, k, last
    last = 3 * (reference%n + N_MODES)
    force = 0
    do p = 1, reference%n_points
      do k = 1, 6
        force = force + (reference%volume(p) * S(k, p)) * kinematics%B(first:last, k, p)
      end do
    end do
  end function stress_forces


  !> The stiffness of the strains, from a given unknown on; amplitudes that are not in use have that of the first.
  pure subroutine integrate_stiffness(reference, kinematics, C, first, is_symmetric, K)
    type(shell_at_rest_type), intent(in) :: reference
    type(layer_strains_type), intent(in) :: kinematics
    real(DP), intent(in) :: C(6, 6, MAX_POINTS)    !< [stress]
    integer, intent(in) :: first
    logical, intent(in) :: is_symmetric
    real(DP), intent(inout) :: K(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< set from first to the last amplitude
    real(DP) :: s(6)
    integer :: p, i, j, l, last, from
    last = 3 * (reference%n + N_MODES)
    K(first:last, first:last) = 0
    do p = 1, reference%n_points
      do j = first, last
        s = reference%volume(p) * matmul(C(:, :, p), kinematics%B(j, :, p))
        from = merge(j, first, is_symmetric)
        do l = 1, 6
          K(from:last, j) = K(from:last, j) + s(l) * kinematics%B(from:last, l, p)
        end do
      end do
    end do
    if (is_symmetric) then
      do j = first, last
        K(j, j + 1:last) = K(j + 1:last, j)
      end do
    end if
    i = 3 * reference%n
    K(i + 1:last, i + 1:last) = K(i + 1:last, i + 1:last) + reference%stack_bending
    do j = i + reference%n_amplitudes + 1, last
      K(j, j) = K(i + 1, i + 1)
    end do
  end subroutine integrate_stiffness


  !> The stiffness of the stresses: sum of S^ij d2 E_ij, with the stresses of the assumed strains summed at their places.
  pure subroutine add_geometric_stiffness(reference, S, K)
    type(shell_at_rest_type), intent(in) :: reference
    real(DP), intent(in) :: S(6, MAX_POINTS)       !< [stress]
    real(DP), intent(inout) :: K(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: natural(6), sampled(MAX_SAMPLES), block(MAX_NODES, MAX_NODES)
    integer :: p, m, a, b, i
    sampled = 0
    block = 0
    do p = 1, reference%n_points
      natural = reference%volume(p) * matmul(S(:, p), reference%to_cartesian(:, :, p))
      associate (slope => reference%slope(:, :, p))
        call add_second_derivative(1, 1, natural(1), slope, block)
        call add_second_derivative(2, 2, natural(2), slope, block)
        call add_second_derivative(1, 2, natural(4), slope, block)
      end associate
      do m = 1, reference%n_samples
        sampled(m) = sampled(m) + dot_product(natural, reference%samples(m)%weight(:, p))
      end do
    end do
    do m = 1, reference%n_samples
      call add_second_derivative(reference%samples(m)%i, reference%samples(m)%j, sampled(m), reference%samples(m)%slope, block)
    end do
    do b = 1, reference%n
      do a = 1, reference%n
        do i = -2, 0
          K(3 * a + i, 3 * b + i) = K(3 * a + i, 3 * b + i) + block(a, b)
        end do
      end do
    end do
  end subroutine add_geometric_stiffness


  !> Translations give no force: the block of a node is minus the sum of its other blocks. Rounding of the
  !! stiffness across the thickness would hold a thin shell against translations.
  pure subroutine balance_translations(n, is_symmetric, K)
    integer, intent(in) :: n                       !< nodes
    logical, intent(in) :: is_symmetric            !< then it stays so to the last bit
    real(DP), intent(inout) :: K(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)
    real(DP) :: total(3, 3)
    integer :: a, b
    do a = 1, n
      total = 0
      do b = 1, n
        if (b /= a) total = total - K(3 * a - 2:3 * a, 3 * b - 2:3 * b)
      end do
      if (is_symmetric) total = 0.5_DP * (total + transpose(total))
      K(3 * a - 2:3 * a, 3 * a - 2:3 * a) = total
    end do
  end subroutine balance_translations


  !> Adds a stress times the second derivative of its natural strain by two means or half differences.
  pure subroutine add_second_derivative(i, j, stress, slope, block)
    integer, intent(in) :: i, j
    real(DP), intent(in) :: stress, slope(3, MAX_NODES)
    real(DP), intent(inout) :: block(MAX_NODES, MAX_NODES)
    real(DP) :: factor
    integer :: b
    factor = merge(0.5_DP, 1.0_DP, i == j) * stress
    do b = 1, MAX_NODES
      block(:, b) = block(:, b) + factor * (slope(i, :) * slope(j, b) + slope(j, :) * slope(i, b))
    end do
  end subroutine add_second_derivative

end module amontons_solid_shell
