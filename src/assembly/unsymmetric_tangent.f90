!> Skew-symmetric part of the tangent from follower pressures and unsymmetric material tangents.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! The load stiffness k = dF_ext/du of a face is not symmetric. Its symmetric part goes into K; W = (k - k')/2, summed over the
!! faces, is stored here as a sparse matrix that only the operator of GMRES includes. Inside a pressurised surface the contributions
!! of adjacent faces cancel, so W is nonzero at its border only; it vanishes where the border is fixed. An unsymmetric material
!! tangent contributes to W too, with the other sign, since it belongs to F_int; that part has the pattern of K. Reference: J.
!! Bonet, R. D. Wood, Nonlinear Continuum Mechanics for Finite Element Analysis (2008), section 8.5.
!!
!! Materials: the element routines take the symmetric part of the tangent c of a point. The rest, w = (c - c')/2, is linear in the
!! stiffness: W = sum of V B' w B over the points, with the strain-displacement matrix B, including the mean dilatation and the mean
!! gradients of the kinds that have them; c is that of the Kirchhoff stress, so V are the reference volumes and B has the current
!! gradients. W' = -W. C3D8I condenses its modes with W itself (amontons_incompatible_modes); of trusses w is zero. Theory:
!! doc/theory/elements.md for B, doc/theory/solver.md for the solution with W.
module amontons_unsymmetric_tangent
  use amontons_kinds, only: DP, PI
  use amontons_errors, only: error_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets, multiply, sparse_sum, sparse_transpose
  use amontons_shape_functions, only: shape_functions, quadrature
  use amontons_tensor, only: IDENTITY, invert
  use amontons_element_kinds, only: element_kind, element_kind_type, KIND_C3D8R, KIND_C3D8_FULL, KIND_CPS4R, KIND_CPE4R, &
    KIND_CAX4R, KIND_CPE4_FULL, FAMILY_SOLID, FAMILY_AXISYMMETRIC, FAMILY_PLANE_STRAIN, FAMILY_PLANE_STRESS, MAX_ELEMENT_NODES, &
    MAX_ELEMENT_POINTS
  implicit none
  private
  public :: skew_part_type, reset_element_skew, reset_load_skew, add_face_skew, assemble_skew, subtract_skew_product, &
    combine_with_skew, has_unsymmetric_law
  public :: evaluate_element_skew

  real(DP), parameter :: TOL_CANCELLED = 1.0e-12_DP  !< of the largest entry of a face: entries below it cancel within rounding [-]

  !> W, and its entries during the loop over the faces.
  type :: skew_part_type
    integer :: n = 0                               !< entries collected
    logical :: has_follower_forces = .false.       !< on nodes
    integer, allocatable :: row(:), column(:)      !< (>= n)
    real(DP), allocatable :: value(:)              !< (>= n) [force/length]
    type(sparse_type) :: elements                  !< U: elements add U - U' [force/length]; not built if not wanted
    type(sparse_type) :: matrix                    !< W over all unknowns, elements included [force/length]; not built if it is zero
  end type skew_part_type

  !> The points of an element in the reference configuration.
  type :: reference_geometry_type
    integer :: n = 0                               !< nodes
    integer :: m = 0                               !< points
    real(DP) :: gradient(3, MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS) = 0   !< dN_a/dX [1/length]
    real(DP) :: hoop(MAX_ELEMENT_NODES, MAX_ELEMENT_POINTS) = 0    !< N_a/X; 0 unless axisymmetric [1/length]
    real(DP) :: volume(MAX_ELEMENT_POINTS) = 0             !< [length^3]
  end type reference_geometry_type

contains

  !> Starts the collection from faces with W = 0.
  pure subroutine reset_load_skew(skew)
    type(skew_part_type), intent(inout) :: skew
    skew%n = 0
    skew%has_follower_forces = .false.
    skew%matrix = sparse_type()
    if (allocated(skew%row)) return
    allocate (skew%row(1024), skew%column(1024), skew%value(1024))
  end subroutine reset_load_skew


  !> Adds (k - k')/2 of a face or of a follower force.
  pure subroutine add_face_skew(skew, nodes, stiffness)
    type(skew_part_type), intent(inout) :: skew
    integer, intent(in) :: nodes(:)                !< of the face
    real(DP), intent(in) :: stiffness(:, :)        !< k, three rows and columns a node [force/length]
    integer :: i, j, m
    m = 3 * size(nodes)
    do while (skew%n + m * m > size(skew%value))
      skew%row = [skew%row, skew%row]
      skew%column = [skew%column, skew%column]
      skew%value = [skew%value, skew%value]
    end do
    do j = 1, m
      do i = 1, m
        skew%n = skew%n + 1
        skew%row(skew%n) = 3 * nodes((i + 2) / 3) - 2 + mod(i - 1, 3)
        skew%column(skew%n) = 3 * nodes((j + 2) / 3) - 2 + mod(j - 1, 3)
        skew%value(skew%n) = 0.5_DP * (stiffness(i, j) - stiffness(j, i))
      end do
    end do
  end subroutine add_face_skew


  !> Before the element loop: sets the upper triangle of the elements' part, with the pattern of K, to zero.
  pure subroutine reset_element_skew(skew, K, is_wanted)
    type(skew_part_type), intent(inout) :: skew
    type(sparse_type), intent(in) :: K             !< upper triangle
    logical, intent(in) :: is_wanted               !< a material may be unsymmetric
    if (.not. is_wanted) return
    if (.not. allocated(skew%elements%value)) skew%elements = K
    skew%elements%value = 0
  end subroutine reset_element_skew


  !> Whether the tangent of a material is unsymmetric now, or forces turn with nodes. The symmetric part need not be positive then,
  !! without a limit point.
  pure logical function has_unsymmetric_law(skew) result(is_so)
    type(skew_part_type), intent(in) :: skew
    is_so = allocated(skew%elements%value)
    if (is_so) is_so = any(skew%elements%value /= 0.0_DP)
    is_so = is_so .or. skew%has_follower_forces
  end function has_unsymmetric_law


  !> Sums the collected entries. Errors: out of memory.
  subroutine assemble_skew(skew, n_unknowns, error)
    type(skew_part_type), intent(inout) :: skew
    integer, intent(in) :: n_unknowns
    type(error_type), allocatable, intent(out) :: error
    call assemble_load_skew(skew, n_unknowns, error)
    if (allocated(error) .or. .not. allocated(skew%elements%value)) return
    if (all(skew%elements%value == 0.0_DP)) return
    if (allocated(skew%matrix%first)) then
      skew%matrix = sparse_sum(skew%matrix, 1.0_DP, sparse_transpose(skew%elements))
    else
      skew%matrix = sparse_transpose(skew%elements)
    end if
    skew%matrix = sparse_sum(skew%matrix, -1.0_DP, skew%elements)
  end subroutine assemble_skew


  !> W of the faces; cancelled entries are dropped. Errors: out of memory.
  subroutine assemble_load_skew(skew, n_unknowns, error)
    type(skew_part_type), intent(inout) :: skew
    integer, intent(in) :: n_unknowns
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: whole
    integer, allocatable :: row(:)
    logical, allocatable :: is_left(:)
    integer :: i
    if (skew%n == 0) return
    associate (n => skew%n)
      call sparse_from_triplets(n_unknowns, n_unknowns, skew%row(:n), skew%column(:n), skew%value(:n), whole, error)
      if (allocated(error)) return
      is_left = abs(whole%value) > TOL_CANCELLED * maxval(abs(skew%value(:n)))
    end associate
    if (.not. any(is_left)) return
    allocate (row(size(whole%value)))
    do i = 1, n_unknowns
      row(whole%first(i):whole%first(i + 1) - 1) = i
    end do
    call sparse_from_triplets(n_unknowns, n_unknowns, pack(row, is_left), pack(whole%column, is_left), pack(whole%value, is_left), &
      skew%matrix, error)
  end subroutine assemble_load_skew


  !> w = w - W du.
  subroutine subtract_skew_product(skew, du, w)
    type(skew_part_type), intent(in) :: skew
    real(DP), intent(in) :: du(:)                  !< (n_unknowns) [length]
    real(DP), intent(inout) :: w(:)                !< (n_unknowns) [force]
    real(DP), allocatable :: change(:)
    if (.not. allocated(skew%matrix%first)) return
    allocate (change, mold=w)
    call multiply(skew%matrix, du, change)
    w = w - change
  end subroutine subtract_skew_product


  !> K - W.
  function combine_with_skew(K, skew) result(whole)
    type(sparse_type), intent(in) :: K             !< all entries, not a triangle
    type(skew_part_type), intent(in) :: skew
    type(sparse_type) :: whole
    if (allocated(skew%matrix%first)) then
      whole = sparse_sum(K, -1.0_DP, skew%matrix)
    else
      whole = K
    end if
  end function combine_with_skew


  !> W of an element.
  pure subroutine evaluate_element_skew(kind, X, u, is_nlgeom, section, w, stiffness, walls)
    integer, intent(in) :: kind                    !< KIND_...
    real(DP), intent(in) :: X(:, :), u(:, :)       !< (3, nodes) [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(in) :: section                !< thickness [length]
    real(DP), intent(in) :: w(:, :, :)             !< (6, 6, points), engineering shears [stress]
    real(DP), intent(out) :: stiffness(3 * MAX_ELEMENT_NODES, 3 * MAX_ELEMENT_NODES)   !< set up to 3 * nodes [force/length]
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    type(element_kind_type) :: entry
    type(reference_geometry_type) :: reference
    real(DP), allocatable :: B(:, :, :)            ! (6, k, points)
    real(DP) :: current(MAX_ELEMENT_POINTS)
    integer :: p, k
    entry = element_kind(kind)
    k = 3 * entry%n_nodes
    stiffness(:k, :k) = 0
    if (.not. any(entry%family == [FAMILY_SOLID, FAMILY_PLANE_STRAIN, FAMILY_PLANE_STRESS, &
      FAMILY_AXISYMMETRIC])) return
    call set_reference_geometry(kind, entry, X, section, reference, walls)
    allocate (B(6, k, reference%m))
    do p = 1, reference%m
      call set_strain_matrix(entry, reference, p, u, is_nlgeom, B(:, :, p), current(p))
    end do
    if (entry%is_mean_dilatation) call apply_mean_dilatation(reference, current, B)
    do p = 1, reference%m
      stiffness(:k, :k) = stiffness(:k, :k) + reference%volume(p) * matmul(transpose(B(:, :, p)), matmul(w(:, :, p), B(:, :, p)))
    end do
  end subroutine evaluate_element_skew


  !> Gradients and volumes in the reference configuration; kinds with one point take their mean over the element.
  pure subroutine set_reference_geometry(kind, entry, X, section, reference, walls)
    integer, intent(in) :: kind
    type(element_kind_type), intent(in) :: entry
    real(DP), intent(in) :: X(:, :)                !< (3, nodes) [length]
    real(DP), intent(in) :: section                !< [length]
    type(reference_geometry_type), intent(out) :: reference
    real(DP), intent(in), optional :: walls(4)     !< of a hollow beam [-]
    real(DP) :: xi(3, MAX_ELEMENT_POINTS), weight(MAX_ELEMENT_POINTS), N(MAX_ELEMENT_NODES), dN(3, MAX_ELEMENT_NODES), J(3, 3), &
      inverse(3, 3), det, radius
    integer :: rule, p, d
    d = merge(3, 2, entry%family == FAMILY_SOLID)
    rule = kind
    if (kind == KIND_C3D8R) rule = KIND_C3D8_FULL
    if (any(kind == [KIND_CPS4R, KIND_CPE4R, KIND_CAX4R])) rule = KIND_CPE4_FULL
    reference%n = entry%n_nodes
    call quadrature(rule, reference%m, xi, weight, walls)
    do p = 1, reference%m
      call shape_functions(rule, xi(:, p), N, dN)
      J = IDENTITY
      J(:d, :d) = matmul(X(:d, :reference%n), transpose(dN(:d, :reference%n)))
      call invert(J, inverse, det)
      reference%gradient(:d, :reference%n, p) = matmul(transpose(inverse(:d, :d)), dN(:d, :reference%n))
      reference%volume(p) = weight(p) * det
      if (entry%family == FAMILY_AXISYMMETRIC) then
        radius = dot_product(N(:reference%n), X(1, :reference%n))
        reference%volume(p) = reference%volume(p) * 2 * PI * radius
        reference%hoop(:reference%n, p) = N(:reference%n) / radius
      else if (d == 2) then
        reference%volume(p) = reference%volume(p) * section
      end if
    end do
    if (rule /= kind) call average_gradients(reference)
  end subroutine set_reference_geometry


  !> Stores the mean over all points in the only point.
  pure subroutine average_gradients(reference)
    type(reference_geometry_type), intent(inout) :: reference
    real(DP) :: share(reference%m), gradient(3, MAX_ELEMENT_NODES), hoop(MAX_ELEMENT_NODES)
    integer :: p
    share = reference%volume(:reference%m) / sum(reference%volume(:reference%m))
    gradient = 0
    hoop = 0
    do p = 1, reference%m
      gradient = gradient + share(p) * reference%gradient(:, :, p)
      hoop = hoop + share(p) * reference%hoop(:, p)
    end do
    reference%volume(1) = sum(reference%volume(:reference%m))
    reference%gradient(:, :, 1) = gradient
    reference%hoop(:, 1) = hoop
    reference%m = 1
  end subroutine average_gradients


  !> B of a point, rows xx yy zz xy yz xz with engineering shears, with the current gradients under NLGEOM; its current volume.
  pure subroutine set_strain_matrix(entry, reference, p, u, is_nlgeom, B, current)
    type(element_kind_type), intent(in) :: entry
    type(reference_geometry_type), intent(in) :: reference
    integer, intent(in) :: p                       !< point
    real(DP), intent(in) :: u(:, :)                !< (3, nodes) [length]
    logical, intent(in) :: is_nlgeom
    real(DP), intent(out) :: B(:, :)               !< (6, 3 nodes) [1/length]
    real(DP), intent(out) :: current               !< [length^3]
    real(DP) :: F(3, 3), inverse(3, 3), det, g(3), hoop
    integer :: a
    inverse = IDENTITY
    current = reference%volume(p)
    hoop = 1
    if (is_nlgeom) then
      F = IDENTITY + matmul(u(:, :reference%n), transpose(reference%gradient(:, :reference%n, p)))
      if (entry%family == FAMILY_AXISYMMETRIC) F(3, 3) = 1 + dot_product(u(1, :reference%n), reference%hoop(:reference%n, p))
      hoop = F(3, 3)
      call invert(F, inverse, det)
      current = det * current
    end if
    B = 0
    do a = 1, reference%n
      g = matmul(reference%gradient(:, a, p), inverse)
      B(:, 3 * a - 2) = [g(1), 0.0_DP, reference%hoop(a, p) / hoop, g(2), 0.0_DP, g(3)]
      B(:, 3 * a - 1) = [0.0_DP, g(2), 0.0_DP, g(1), g(3), 0.0_DP]
      B(:, 3 * a) = [0.0_DP, 0.0_DP, g(3), 0.0_DP, g(2), g(1)]
    end do
  end subroutine set_strain_matrix


  !> Replaces the volume change of each point by its mean over the current volume.
  pure subroutine apply_mean_dilatation(reference, current, B)
    type(reference_geometry_type), intent(in) :: reference
    real(DP), intent(in) :: current(:)             !< (points) [length^3]
    real(DP), intent(inout) :: B(:, :, :)          !< (6, 3 nodes, points) [1/length]
    real(DP) :: mean(size(B, 2)), change(size(B, 2))
    integer :: p, i
    mean = 0
    do p = 1, reference%m
      mean = mean + current(p) / sum(current(:reference%m)) * (B(1, :, p) + B(2, :, p) + B(3, :, p))
    end do
    do p = 1, reference%m
      change = (mean - (B(1, :, p) + B(2, :, p) + B(3, :, p))) / 3
      do i = 1, 3
        B(i, :, p) = B(i, :, p) + change
      end do
    end do
  end subroutine apply_mean_dilatation

end module amontons_unsymmetric_tangent
