!> Preconditioner of the contact subproblem on wide interfaces: one solution with the bulk, then dense solves on small tiles of the
!! contact skin (the nodes of all contact rows).
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Theory: doc/theory/solver.md, "The contact skin". With K_rho = K + rho sum c_s B_s'B_s (Robin springs between slave nodes and
!! master) and P ~ inv(K_rho), one application to a force r on the free unknowns is
!!
!!     x = R Pi P Pi' R' r,      then on each tile F:  x_F = x_F + inv(J_FF) (r - J x)_F
!!
!! R restricts to the free unknowns. Pi = 1 - D A projects the slave nodes onto the rows A of contact in the directions D of these
!! rows; slaves of compliant laws follow their masters in part. P depends on no status and no friction, so that it serves many
!! increments. The tiles are recomputed for each tangent.
module amontons_contact_preconditioner
  use amontons_kinds, only: DP
  use amontons_errors, only: error_type
  use amontons_controls, only: skin_controls_type
  use amontons_sparse, only: sparse_type, sparse_from_triplets, sparse_transpose, sparse_product, sparse_sum, multiply, &
    multiply_transpose
  use amontons_dense, only: solve_small
  use amontons_constraints, only: constraints_type
  use amontons_reduced_system, only: reduced_system_type, apply_reduced_inverse
  use amontons_contact_coarse_space, only: coarse_space_type, coarse_rows_type, build_coarse_space, update_coarse_space, &
    apply_coarse_correction
  use amontons_point_partition, only: partition_points
  use amontons_contact_tiles, only: tangent_parts_type, tile_type, factorise_tiles, correct_tiles
  implicit none
  private
  public :: skin_type, skin_memory_type, partition_skin, build_skin_coarse_space, update_skin, apply_bulk, apply_coarse_space, &
    apply_tiles, subtract_contact

  type(skin_controls_type), parameter :: DEFAULTS = skin_controls_type()

  !> What the preconditioner follows from beside the displacements at its computation; a checkpoint keeps it.
  type :: skin_memory_type
    type(sparse_type) :: springs                   !< Robin springs, upper triangle (n_unknowns x n_unknowns) [force/length]
    logical, allocatable :: is_near(:)             !< (n_slaves) slaves with a Robin spring
    integer :: n_slow = 0                          !< slow Krylov solves since P was computed
    integer :: slow_limit = DEFAULTS%max_slow_solves                       !< slow solves until P is recomputed
    logical :: is_outdated = .false.               !< P is recomputed for the next Newton direction
    logical :: is_factor_needed = .false.          !< two levels did not serve: the bulk gets a factor
    logical :: is_abandoned = .false.              !< the dense interface serves this step better
  end type skin_memory_type

  !> The preconditioner.
  type :: skin_type
    type(skin_memory_type) :: memory
    logical :: is_ready = .false.                  !< P is available
    character(:), allocatable :: message           !< to be logged: another solver serves this step; unallocated: nothing to say
    type(reduced_system_type) :: robin                    !< K_rho and its solver P
    type(sparse_type) :: by_imbalance              !< D_R of the tangent (n_unknowns x n_unknowns) [-]
    type(sparse_type) :: by_displacement           !< D_u of the tangent (n_unknowns x n_unknowns) [force/length]
    integer, allocatable :: tile_of_node(:)        !< (n_nodes) tile of each slave node, at the computation of P; 0: no slave node
    integer :: n_tiles = 0
    integer, allocatable, private :: unknown_of(:) !< (n_free) index of each free unknown among all
    integer, allocatable, private :: free_of(:)    !< (free unknowns of the skin) number among all free ones
    integer, allocatable, private :: skin_of_free(:)   !< (the same) unknown of the skin
    type(sparse_type), private :: rows             !< A (n_dependent x n_unknowns) [-]
    type(sparse_type), private :: directions       !< D' (n_dependent x n_unknowns) [-]
    integer, allocatable, private :: bulk_of(:)    !< (n_unknowns) index in K_rho; 0: not in it
    integer, private :: n_bulk = 0
    type(tangent_parts_type), private :: parts
    type(sparse_type), private :: jumps            !< S N (free unknowns of the skin, squared): v_s = jump + S N v [-]
    type(tile_type), allocatable, private :: tiles(:)
    type(coarse_space_type), private :: coarse
  end type skin_type

contains

  !> Partitions the slave nodes into tiles.
  subroutine partition_skin(self, place, node, slaves_per_tile)
    type(skin_type), intent(inout) :: self
    real(DP), intent(in) :: place(:, :)            !< (3, n_nodes) coordinates [length]
    integer, intent(in) :: node(:)                 !< slave nodes, each once
    integer, intent(in) :: slaves_per_tile         !< at most
    integer :: tile(size(node))
    call partition_points(place(:, node), slaves_per_tile, tile, self%n_tiles)
    if (allocated(self%tile_of_node)) deallocate (self%tile_of_node)
    allocate (self%tile_of_node(size(place, 2)), source=0)
    self%tile_of_node(node) = tile
    if (allocated(self%tiles)) deallocate (self%tiles)
    allocate (self%tiles(self%n_tiles))
  end subroutine partition_skin


  !> The coarse space of P, in about so many patches of the slave nodes.
  subroutine build_skin_coarse_space(self, base, place, n_patches)
    type(skin_type), intent(inout) :: self         !< with its tiles, springs and P
    type(constraints_type), intent(in) :: base     !< without contact rows
    real(DP), intent(in) :: place(:, :)            !< (3, n_nodes) coordinates [length]
    integer, intent(in) :: n_patches
    call build_coarse_space(self%coarse, self%robin, self%memory%springs, base, place, self%tile_of_node > 0, n_patches)
  end subroutine build_skin_coarse_space


  !> Updates the preconditioner for a tangent: projection and tiles.
  subroutine update_skin(self, base, whole, stiffness, rows, motion, error)
    type(skin_type), intent(inout), target :: self   !< with its tiles, D_R and D_u; P may be computed later
    type(constraints_type), intent(in) :: base     !< without contact rows
    type(constraints_type), intent(in), target :: whole       !< with them
    type(sparse_type), intent(in), target :: stiffness        !< K, upper triangle (n_unknowns x n_unknowns) [force/length]
    type(sparse_type), intent(in) :: rows          !< nodes (columns) of the contact row of each slave and the sizes of their
                                                   !! weights, the slave node first
    type(sparse_type), intent(in) :: motion        !< S N of the slaves of compliant laws (n_unknowns x n_unknowns) [-]
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: skin_of(:), tile_of(:)
    integer :: i
    if (allocated(self%unknown_of)) deallocate (self%unknown_of)
    allocate (self%unknown_of(whole%n_free))
    do i = 1, whole%n_unknowns
      if (whole%free_of(i) > 0) self%unknown_of(whole%free_of(i)) = i
    end do
    self%bulk_of = base%free_of
    self%n_bulk = base%n_free
    call relate_rows(self, base, whole, motion, error)
    if (allocated(error)) return
    call update_coarse_space(self%coarse, coarse_rows_type(stiffness, self%rows, self%directions, self%by_imbalance, &
      self%by_displacement, whole%transformation, self%bulk_of, self%unknown_of))
    call number_skin_nodes(self, rows, skin_of, tile_of)
    call extract_skin_tangent(self, whole, stiffness, skin_of, error)
    if (allocated(error)) return
    call relate_jumps(self, motion, skin_of, error)
    if (allocated(error)) return
    call assign_tile_unknowns(self, tile_of)
    call factorise_tiles(self%parts, self%tiles, error)
  end subroutine update_skin


  !> A and D: the rows of unknowns that contact makes dependent, and for each the direction of projection at its node; then the rows
  !! S (u_s - N u) of the unknowns that follow their masters under a compliant law, each with its own direction.
  subroutine relate_rows(self, base, whole, motion, error)
    type(skin_type), intent(inout) :: self
    type(constraints_type), intent(in) :: base, whole
    type(sparse_type), intent(in) :: motion        !< S N (n_unknowns x n_unknowns) [-]
    type(error_type), allocatable, intent(out) :: error
    integer, allocatable :: row(:), column(:), d_row(:), d_column(:)
    real(DP), allocatable :: value(:), d_value(:)
    real(DP) :: own(3, 3), inverse(3, 3)
    integer :: i, j, k, m, n, n_d, n_rows, node, dependent(3)
    m = count(base%owner == 0 .and. whole%owner > 0)
    n = m
    do i = 1, whole%n_unknowns
      if (base%owner(i) == 0 .and. whole%owner(i) > 0) n = n + whole%transformation%first(i + 1) - whole%transformation%first(i)
    end do
    n = n + 2 * size(motion%column)
    m = 3 * m + count(motion%first(2:) > motion%first(:motion%n_rows))
    allocate (row(n), column(n), value(n), d_row(m), d_column(m), d_value(m))
    n = 0
    n_d = 0
    n_rows = 0
    do node = 1, whole%n_unknowns / 3
      own = 0.0_DP
      k = 0
      do j = 1, 3
        i = 3 * (node - 1) + j
        if (base%owner(i) /= 0 .or. whole%owner(i) <= 0) cycle
        k = k + 1
        dependent(k) = n_rows + k
        call put_row(i, dependent(k), own(k, :))
      end do
      if (k == 0) cycle
      n_rows = n_rows + k
      call invert_own(own(:k, :), inverse(:, :k))
      do j = 1, k
        d_row(n_d + 1:n_d + 3) = dependent(j)
        d_column(n_d + 1:n_d + 3) = 3 * (node - 1) + [1, 2, 3]
        d_value(n_d + 1:n_d + 3) = inverse(:, j)
        n_d = n_d + 3
      end do
    end do
    do i = 1, motion%n_rows
      if (motion%first(i + 1) > motion%first(i) .and. whole%free_of(i) > 0) call put_following(i)
    end do
    call sparse_from_triplets(n_rows, whole%n_unknowns, row(:n), column(:n), value(:n), self%rows, error)
    if (allocated(error)) return
    call sparse_from_triplets(n_rows, whole%n_unknowns, d_row(:n_d), d_column(:n_d), d_value(:n_d), self%directions, error)

  contains

    !> The row e_i - T_i, and its entries at its own node.
    subroutine put_row(unknown, number, at_node)
      integer, intent(in) :: unknown, number
      real(DP), intent(inout) :: at_node(3)
      integer :: p, other
      call put(number, unknown, 1.0_DP)
      at_node(unknown - 3 * (node - 1)) = 1.0_DP
      do p = whole%transformation%first(unknown), whole%transformation%first(unknown + 1) - 1
        other = self%unknown_of(whole%transformation%column(p))
        call put(number, other, -whole%transformation%value(p))
        if ((other + 2) / 3 == node) at_node(other - 3 * (node - 1)) = -whole%transformation%value(p)
      end do
    end subroutine put_row

    !> The row S (u_s - N u) of an unknown that follows its masters: S is the sum of S N over them.
    subroutine put_following(unknown)
      integer, intent(in) :: unknown
      integer :: p
      n_rows = n_rows + 1
      do p = motion%first(unknown), motion%first(unknown + 1) - 1
        call put(n_rows, motion%column(p), -motion%value(p))
        call put(n_rows, 3 * ((unknown - 1) / 3) + modulo(motion%column(p) - 1, 3) + 1, motion%value(p))
      end do
      n_d = n_d + 1
      d_row(n_d) = n_rows
      d_column(n_d) = unknown
      d_value(n_d) = 1.0_DP
    end subroutine put_following

    !> One entry of A.
    subroutine put(number, unknown, amount)
      integer, intent(in) :: number, unknown
      real(DP), intent(in) :: amount
      n = n + 1
      row(n) = number
      column(n) = unknown
      value(n) = amount
    end subroutine put

  end subroutine relate_rows


  !> a'(a a')^-1 of one, two or three rows at a node.
  subroutine invert_own(own, inverse)
    real(DP), intent(in) :: own(:, :)              !< a (k, 3)
    real(DP), intent(out) :: inverse(:, :)         !< (3, k)
    real(DP) :: gram(size(own, 1), size(own, 1)), solution(size(own, 1), 3)
    integer :: status
    gram = matmul(own, transpose(own))
    call solve_small(gram, own, solution, status)
    inverse = transpose(solution)                  ! 0 if the rows were linearly dependent, which they are not
  end subroutine invert_own


  !> The unknowns of the skin: the nodes of all rows. A master node belongs to the tile of the row with its largest weight, of equal
  !! ones the first.
  subroutine number_skin_nodes(self, rows, skin_of, tile_of)
    type(skin_type), intent(in) :: self
    type(sparse_type), intent(in) :: rows
    integer, allocatable, intent(out) :: skin_of(:)   !< (n_nodes) number in the skin; 0: not in it
    integer, allocatable, intent(out) :: tile_of(:)   !< (nodes of the skin)
    real(DP) :: largest(size(self%tile_of_node))   ! weights [-]
    integer :: i, p, n, tile
    allocate (skin_of(size(self%tile_of_node)), tile_of(size(self%tile_of_node)))
    skin_of = 0
    largest = -1.0_DP
    n = 0
    do i = 1, rows%n_rows
      tile = self%tile_of_node(rows%column(rows%first(i)))
      do p = rows%first(i), rows%first(i + 1) - 1
        associate (node => rows%column(p))
          if (skin_of(node) == 0) then
            n = n + 1
            skin_of(node) = n
            tile_of(n) = self%tile_of_node(node)
          end if
          if (self%tile_of_node(node) > 0 .or. rows%value(p) <= largest(skin_of(node))) cycle
          tile_of(skin_of(node)) = tile
          largest(skin_of(node)) = rows%value(p)
        end associate
      end do
    end do
    tile_of = tile_of(:n)
  end subroutine number_skin_nodes


  !> Extracts the parts of the tangent on the skin.
  subroutine extract_skin_tangent(self, whole, stiffness, skin_of, error)
    type(skin_type), intent(inout) :: self
    type(constraints_type), intent(in) :: whole
    type(sparse_type), intent(in) :: stiffness
    integer, intent(in) :: skin_of(:)              !< (n_nodes)
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: extracted
    integer, allocatable :: unknown(:), skin(:), free(:)
    integer :: i, n, node
    n = 3 * maxval([0, skin_of])
    allocate (unknown(n), skin(whole%n_unknowns), free(whole%n_free))
    skin = 0
    do node = 1, size(skin_of)
      if (skin_of(node) == 0) cycle
      do i = 1, 3
        unknown(3 * (skin_of(node) - 1) + i) = 3 * (node - 1) + i
        skin(3 * (node - 1) + i) = 3 * (skin_of(node) - 1) + i
      end do
    end do
    self%free_of = pack(whole%free_of(unknown), whole%free_of(unknown) > 0)
    self%skin_of_free = pack([(i, i=1, n)], whole%free_of(unknown) > 0)
    free = 0
    free(self%free_of) = [(i, i=1, size(self%free_of))]
    call extract_rows(whole%transformation, unknown, free, size(self%free_of), self%parts%relation, error)
    if (allocated(error)) return
    call extract_rows(stiffness, unknown, skin, n, self%parts%stiffness, error, is_symmetric=.true.)
    if (allocated(error)) return
    call extract_rows(self%by_imbalance, unknown, skin, n, extracted, error)
    if (allocated(error)) return
    self%parts%by_imbalance_t = sparse_transpose(extracted)
    call extract_rows(self%by_displacement, unknown, skin, n, extracted, error)
    if (.not. allocated(error)) self%parts%by_displacement_t = sparse_transpose(extracted)
  end subroutine extract_skin_tangent


  !> Slaves of compliant laws follow their masters on the skin: T (1 + S N) in place of T.
  subroutine relate_jumps(self, motion, skin_of, error)
    type(skin_type), intent(inout) :: self
    type(sparse_type), intent(in) :: motion        !< S N (n_unknowns x n_unknowns) [-]
    integer, intent(in) :: skin_of(:)              !< (n_nodes)
    type(error_type), allocatable, intent(out) :: error
    type(sparse_type) :: masters                   !< S N on the skin (free unknowns of the skin x unknowns of the skin) [-]
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: p, n, k, n_free
    n_free = size(self%free_of)
    n = size(motion%column)
    allocate (row(n), column(n), value(n))
    n = 0
    do k = 1, n_free
      associate (unknown => self%unknown_of(self%free_of(k)))
        do p = motion%first(unknown), motion%first(unknown + 1) - 1
          n = n + 1
          row(n) = k
          column(n) = 3 * (skin_of((motion%column(p) + 2) / 3) - 1) + modulo(motion%column(p) - 1, 3) + 1
          value(n) = motion%value(p)
        end do
      end associate
    end do
    call sparse_from_triplets(n_free, self%parts%relation%n_rows, row(:n), column(:n), value(:n), masters, error)
    if (allocated(error)) return
    self%jumps = sparse_product(masters, self%parts%relation)
    if (n > 0) self%parts%relation = sparse_sum(self%parts%relation, 1.0_DP, sparse_product(self%parts%relation, self%jumps))
    self%parts%relation_t = sparse_transpose(self%parts%relation)
  end subroutine relate_jumps


  !> Extracts a submatrix: some rows, and the columns with a new index. A symmetric matrix is given by its upper triangle; the
  !! submatrix has both triangles.
  subroutine extract_rows(matrix, rows, number, n_columns, extracted, error, is_symmetric)
    type(sparse_type), intent(in) :: matrix
    integer, intent(in) :: rows(:)
    integer, intent(in) :: number(:)               !< (n_columns of matrix) new index; 0: not extracted
    integer, intent(in) :: n_columns
    type(sparse_type), intent(out) :: extracted        !< (size(rows) x n_columns)
    type(error_type), allocatable, intent(out) :: error
    logical, intent(in), optional :: is_symmetric
    integer, allocatable :: row(:), column(:)
    real(DP), allocatable :: value(:)
    integer :: i, p, n
    logical :: is_both
    is_both = .false.
    if (present(is_symmetric)) is_both = is_symmetric
    n = sum(matrix%first(rows + 1) - matrix%first(rows))
    if (is_both) n = 2 * n
    allocate (row(n), column(n), value(n))
    n = 0
    do i = 1, size(rows)
      do p = matrix%first(rows(i)), matrix%first(rows(i) + 1) - 1
        if (number(matrix%column(p)) == 0) cycle
        n = n + 1
        row(n) = i
        column(n) = number(matrix%column(p))
        value(n) = matrix%value(p)
        if (.not. is_both .or. column(n) == i) cycle
        n = n + 1
        row(n) = column(n - 1)
        column(n) = i
        value(n) = value(n - 1)
      end do
    end do
    call sparse_from_triplets(size(rows), n_columns, row(:n), column(:n), value(:n), extracted, error)
  end subroutine extract_rows


  !> The free unknowns of each tile.
  subroutine assign_tile_unknowns(self, tile_of)
    type(skin_type), intent(inout) :: self
    integer, intent(in) :: tile_of(:)              !< (nodes of the skin)
    integer :: tile(size(self%free_of)), n(self%n_tiles), k, t
    tile = tile_of((self%skin_of_free + 2) / 3)
    n = 0
    do k = 1, size(tile)
      n(tile(k)) = n(tile(k)) + 1
    end do
    do t = 1, self%n_tiles
      if (allocated(self%tiles(t)%member)) deallocate (self%tiles(t)%member)
      allocate (self%tiles(t)%member(n(t)))
    end do
    n = 0
    do k = 1, size(tile)
      t = tile(k)
      n(t) = n(t) + 1
      self%tiles(t)%member(n(t)) = k
    end do
  end subroutine assign_tile_unknowns


  !> x = R Pi P Pi' R' r.
  subroutine apply_bulk(self, r, x)
    type(skin_type), intent(inout) :: self
    real(DP), intent(in) :: r(:)                   !< (n_free) [force]
    real(DP), intent(out) :: x(:)                  !< (n_free) [length]
    real(DP), allocatable :: g(:), change(:), t(:), b(:), y(:)
    integer :: i
    allocate (g(size(self%bulk_of)), change(size(self%bulk_of)), t(self%rows%n_rows), b(self%n_bulk), y(self%n_bulk))
    g = 0.0_DP
    g(self%unknown_of) = r
    call multiply(self%directions, g, t)
    call multiply_transpose(self%rows, t, change)
    do i = 1, size(g)
      if (self%bulk_of(i) > 0) b(self%bulk_of(i)) = g(i) - change(i)
    end do
    call apply_reduced_inverse(self%robin, b, y)
    do i = 1, size(g)
      g(i) = 0.0_DP
      if (self%bulk_of(i) > 0) g(i) = y(self%bulk_of(i))
    end do
    call project_displacement(self, g, x)
  end subroutine apply_bulk


  !> x = R Pi g.
  subroutine project_displacement(self, g, x)
    type(skin_type), intent(in) :: self
    real(DP), intent(in) :: g(:)                   !< (n_unknowns) [length]
    real(DP), intent(out) :: x(:)                  !< (n_free) [length]
    real(DP), allocatable :: t(:), change(:)
    allocate (t(self%rows%n_rows), change(size(g)))
    call multiply(self%rows, g, t)
    call multiply_transpose(self%directions, t, change)
    x = g(self%unknown_of) - change(self%unknown_of)
  end subroutine project_displacement


  !> x = x + R Pi W y and d = d - J W y, with y = inv(W'J W) W'd.
  subroutine apply_coarse_space(self, d, x)
    type(skin_type), intent(in) :: self
    real(DP), intent(inout) :: d(:)                !< (n_free) r - J x [force]
    real(DP), intent(inout) :: x(:)                !< (n_free) [length]
    real(DP), allocatable :: g(:), change(:)
    logical :: is_corrected
    allocate (g(size(self%bulk_of)), change(size(x)))
    call apply_coarse_correction(self%coarse, d, g, is_corrected)
    if (.not. is_corrected) return
    call project_displacement(self, g, change)
    x = x + change
  end subroutine apply_coarse_space


  !> x_F = x_F + inv(J_FF) d_F on all tiles.
  subroutine apply_tiles(self, d, x)
    type(skin_type), intent(in) :: self
    real(DP), intent(in) :: d(:)                   !< (n_free) r - J x [force]
    real(DP), intent(inout) :: x(:)                !< (n_free) [length]
    real(DP) :: force(size(self%free_of)), correction(size(self%free_of)), of_masters(size(self%free_of))
    call multiply_transpose(self%jumps, d(self%free_of), force)
    correction = 0.0_DP
    call correct_tiles(self%tiles, d(self%free_of) + force, correction)
    call multiply(self%jumps, correction, of_masters)
    x(self%free_of) = x(self%free_of) + correction + of_masters
  end subroutine apply_tiles


  !> w = w - dF_c, with the change of the contact forces dF_c = D_R dRhat + D_u du.
  subroutine subtract_contact(self, du, d_imbalance, w)
    type(skin_type), intent(in) :: self
    real(DP), intent(in) :: du(:)                  !< (n_unknowns) [length]
    real(DP), intent(in) :: d_imbalance(:)         !< (n_unknowns) dRhat, condensed [force]
    real(DP), intent(inout) :: w(:)                !< (n_unknowns) [force]
    real(DP), allocatable :: d_force(:)
    allocate (d_force(size(w)))
    call multiply(self%by_imbalance, d_imbalance, d_force)
    w = w - d_force
    call multiply(self%by_displacement, du, d_force)
    w = w - d_force
  end subroutine subtract_contact

end module amontons_contact_preconditioner
